// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include <fmt/format.h>

#include "lessons/lesson_parts.h"
#include "lessons/pedicle_screw/pedicle_screw_rubric.h"
#include "lessons/spine/finder.h"
#include "lessons/spine/spine_critical.h"
#include "lessons/spine/spine_report.h"
#include "lessons/spine/spine_scan.h"

namespace trephine::lessons {
namespace {

// Those of the open exercise [Rizzi, chapter 8.2.2]: a pedicle finder, and screws of several sizes, each a tool named
// by its diameter and length: screw_5.5x40.
std::vector<haptics::BeltToolParams> pedicle_screw_tools() {
  const haptics::BeltToolParams finder = finder_tool();
  std::vector<haptics::BeltToolParams> all = {finder};
  for (const double diameter : {5.5, 6.5})
    for (const double length : {35.0, 40.0, 45.0, 50.0}) {
      haptics::BeltToolParams screw = finder;
      screw.tool = "screw";
      screw.name = fmt::format("screw_{}x{:.0f}", diameter, length);
      screw.tool_diameter_mm = diameter;
      screw.tool_length_mm = length;
      screw.tool_spacing_mm = 3;  // not more points than a tool may have
      all.push_back(screw);
    }
  for (haptics::BeltToolParams& t : all) static_cast<haptics::ToolParams&>(t) = haptics::own_tool(t);
  return all;
}

}  // namespace

LessonType pedicle_screw_lesson() {
  LessonType m;
  m.name = "pedicle_screw";
  m.german_title = "Pedikelschraube";
  m.summary = "a pedicle finder and a screw, judged by five errors";
  m.rows = {"entry", "axial", "sagittal", "length", "breach", "acceptable", "size", "exposure", "passes", "time"};
  set_five_errors_lesson(m, JudgedTool::screw);
  m.tools = pedicle_screw_tools;
  m.tasks = [](const cases::CaseManifest& manifest) {
    std::vector<LessonTask> all;
    for (const std::string& name : pedicle_tasks(manifest))
      all.push_back({name,
                     "A screw of the size that fits through " + pedicle_in_words(name) +
                         ", after the finder: its head on the bone, its tip in the front half of the body.",
                     "A lumbar fusion: the vertebra is to be held by its pedicles.",
                     "Eine Schraube der passenden Größe durch " + pedicle_in_words(name, true) +
                         ", nach dem Pfriem: der Kopf am Knochen, die Spitze in der vorderen Hälfte des Wirbelkörpers.",
                     "Eine Versteifung: der Wirbel soll an seinen Pedikeln gehalten werden.",
                     pedicle_doubt(manifest, name)});
    return all;
  };
  m.score = [](const LessonFacts& facts, const cases::LoadedCase& loaded, const voxel::HapticVolume& before,
               const AnyParams& rubric) {
    return score_five_errors(static_cast<const SpineNeedleFacts&>(facts), loaded.manifest, before,
                             rubric.as<PedicleScrewRubric>(), JudgedTool::screw);
  };
  m.facts_of_outcome = screw_facts_of_scan;
  m.texts = {
      {"screw {} x {} mm", "Schraube {} x {} mm"},
      {"Turn in a screw of the size that fits", "Schraube der passenden Größe eindrehen"},
      {"Half to four fifths of the pedicle's width hold without bursting it; the finder's depth says the length.",
       "Die halbe bis vier Fünftel der Breite des Pedikels halten, ohne ihn zu sprengen; die Tiefe des Pfriems "
       "sagt die Länge."},
      {"The head lies on the bone, and both views show the tip in the body.",
       "Der Kopf liegt am Knochen, und in beiden Ansichten liegt die Spitze im Wirbelkörper."}};
  append(m.texts, finder_words());
  append(m.texts, spine_words());
  m.guide = [](const LessonFacts& facts) {
    LessonGuide finder = finder_guide();
    const SpineNeedleFacts& f = static_cast<const SpineNeedleFacts&>(facts);
    finder.done = std::any_of(f.passes.begin(), f.passes.end(),
                              [&](const NeedlePass& p) { return p.tool == finder.tool && !is_still_in(p, f); });
    return std::vector<LessonGuide>{
        finder,
        {"Turn in a screw of the size that fits", "screw_*", "",
         "Half to four fifths of the pedicle's width hold without bursting it; the finder's depth says the length.",
         "The head lies on the bone, and both views show the tip in the body."},
        {"Finish the lesson", "", "finish", "What is left in place is judged.",
         "The head lies on the bone, and both views show the tip in the body."}};
  };
  return m;
}

}  // namespace trephine::lessons
