// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/pedicle_finder/pedicle_finder_rubric.h"
#include "lessons/spine/finder.h"
#include "lessons/spine/spine_critical.h"
#include "lessons/spine/spine_report.h"

namespace trephine::lessons {
namespace {

constexpr const char *why = "What is left in place is judged.", *in_body = "Both views show the tip in the body.";

std::vector<haptics::BeltToolParams> pedicle_finder_tools() {
  haptics::BeltToolParams finder = finder_tool();
  static_cast<haptics::ToolParams&>(finder) = haptics::own_tool(finder);
  return {finder};
}

}  // namespace

LessonType pedicle_finder_lesson() {
  LessonType m;
  m.name = "pedicle_finder";
  m.german_title = "Pfriem durch den Pedikel";
  m.summary = "a pedicle finder alone, judged by the five errors of the screw that would follow it";
  m.rows = {"entry", "axial", "sagittal", "length", "breach", "acceptable", "exposure", "passes", "time"};
  set_five_errors_lesson(m, JudgedTool::finder);
  m.tools = pedicle_finder_tools;
  m.tasks = [](const cases::CaseManifest& manifest) {
    std::vector<LessonTask> all;
    for (const std::string& name : pedicle_tasks(manifest))
      all.push_back({name,
                     "The finder through " + pedicle_in_words(name) +
                         ", as a screw is to lie: its tip in the front half of the body.",
                     "A lumbar fusion: the hole for a screw.",
                     "Der Pfriem durch " + pedicle_in_words(name, true) +
                         ", wie eine Schraube liegen soll: die Spitze in der vorderen Hälfte des Wirbelkörpers.",
                     "Eine Versteifung: das Loch für eine Schraube.", pedicle_doubt(manifest, name)});
    return all;
  };
  m.score = [](const LessonFacts& facts, const cases::LoadedCase& loaded, const voxel::HapticVolume& before,
               const AnyParams& rubric) {
    return score_five_errors(static_cast<const SpineNeedleFacts&>(facts), loaded.manifest, before,
                             rubric.as<PedicleFinderRubric>(), JudgedTool::finder);
  };
  m.texts = {{in_body, "In beiden Ansichten liegt die Spitze im Wirbelkörper."}};
  append(m.texts, finder_words());
  append(m.texts, spine_words());
  m.guide = [](const LessonFacts&) {
    return std::vector<LessonGuide>{finder_guide(), {"Finish the lesson", "", "finish", why, in_body}};
  };
  return m;
}

}  // namespace trephine::lessons
