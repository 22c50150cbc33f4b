// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "lessons/pedicle_screw/pedicle_screw_score.h"
#include "lessons/spine/spine_critical.h"
#include "lessons/spine/spine_moves.h"
#include "lessons/spine/spine_report.h"

namespace trephine::lessons {
namespace {

// Those of the open exercise [Rizzi, chapter 8.2.2]: a pedicle finder, and screws of several sizes, each a tool named
// by its diameter and length: screw_5.5x40.
std::vector<haptics::BeltToolParams> pedicle_screw_tools() {
  haptics::BeltToolParams finder;
  finder.name = "finder";
  finder.tool = "jamshidi";
  finder.tool_diameter_mm = 4;
  finder.tool_length_mm = 80;
  finder.pierce_n = 2;  // ours: less than a needle's, for it comes from the exposed bone
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
  const auto measured = [&](const char* row, const char* name) {
    m.columns.push_back({name, std::string("measured for the row ") + row, row});
  };
  measured("entry", "coronal_entry_off_mm");
  measured("axial", "axial_off_deg");
  measured("sagittal", "sagittal_off_deg");
  measured("length", "tip_beyond_target_mm");
  measured("breach", "breach_mm");
  measured("exposure", "exposure_s");
  measured("time", "procedure_s");
  m.columns.push_back({"errors_count", "of the five", ""});
  m.columns.push_back({"acceptable", "1 or 0: not more errors than the rubric allows", ""});
  m.columns.push_back({"screw_length_mm", "of the screw in place; 0: none", ""});
  m.columns.push_back({"screw_diameter_mm", "of the screw in place; 0: none", ""});
  for (const char* wall : {"medial", "lateral", "upper", "lower"})
    m.columns.push_back({std::string(wall) + "_wall_mm", "how far the screw in place stands beyond that wall", ""});
  m.columns.push_back({"gertzbein_grade", "of the screw in place by Gertzbein and Robbins: 0 (A) to 4 (E)", ""});
  m.columns.push_back({"passes_count", "how often a tool entered bone", ""});
  m.columns.push_back({"shots_count", "how often X-rays were on", ""});
  m.steps = spine_steps();
  m.require = [](const cases::CaseManifest& manifest) { spine_bone_of(manifest); };
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
  m.plan = plan_spine_moves;
  m.begin = [](const cases::CaseManifest& manifest, const voxel::HapticVolume&, const voxel::HapticVolume&) {
    return std::unique_ptr<Lesson>(std::make_unique<SpineNeedle>(manifest));
  };
  m.score = [](const LessonFacts& facts, const cases::LoadedCase& loaded, const voxel::HapticVolume& before,
               const AnyParams& rubric) {
    return score_pedicle_screw(static_cast<const SpineNeedleFacts&>(facts), loaded.manifest, before,
                               rubric.as<PedicleScrewRubric>());
  };
  m.facts_json = spine_facts_json;
  m.outcome = [](const LessonFacts&, const LessonScore& score) {
    const bool graded = score.known("gertzbein_grade");
    return texts::Phrase("passes: {}, errors: {}, {}, grade {}",
                         {std::to_string(score.count("passes_count")),
                          score.known("errors_count") ? std::to_string(score.count("errors_count")) : "not judged",
                          !score.flag("screw_in_bone") ? "no screw lies in bone"
                          : !score.known("acceptable") ? "the pedicle is doubtful"
                          : score.flag("acceptable")   ? "acceptable"
                                                       : "not acceptable",
                          graded ? std::string(1, char('A' + score.count("gertzbein_grade"))) : "not judged"});
  };
  m.headline = [](const LessonFacts&, const LessonScore& score) {
    return texts::Phrase("errors of the screw: {}",
                         {score.known("errors_count") ? std::to_string(score.count("errors_count")) : "not judged"});
  };
  m.pictures = spine_pictures;
  m.status = spine_status;
  m.texts = {
      {"screw {} x {} mm", "Schraube {} x {} mm"},
      {"Pass the finder through the pedicle", "Pfriem durch den Pedikel führen"},
      {"A finder follows the soft middle of the pedicle, and makes the way that the screw takes.",
       "Der Pfriem folgt der weichen Mitte des Pedikels und macht den Weg, den die Schraube nimmt."},
      {"Even resistance all the way: a sudden give is a wall.",
       "Gleichmäßiger Widerstand auf dem ganzen Weg: ein plötzliches Nachgeben ist eine Wand."},
      {"Turn in a screw of the size that fits", "Schraube der passenden Größe eindrehen"},
      {"Half to four fifths of the pedicle's width hold without bursting it; the finder's depth says the length.",
       "Die halbe bis vier Fünftel der Breite des Pedikels halten, ohne ihn zu sprengen; die Tiefe des Pfriems "
       "sagt die Länge."},
      {"The head lies on the bone, and both views show the tip in the body.",
       "Der Kopf liegt am Knochen, und in beiden Ansichten liegt die Spitze im Wirbelkörper."}};
  append(m.texts, spine_words());
  m.guide = [](const LessonFacts&) {
    return std::vector<LessonGuide>{
        {"Pass the finder through the pedicle", "finder", "",
         "A finder follows the soft middle of the pedicle, and makes the way that the screw takes.",
         "Even resistance all the way: a sudden give is a wall."},
        {"Turn in a screw of the size that fits", "screw_*", "",
         "Half to four fifths of the pedicle's width hold without bursting it; the finder's depth says the length.",
         "The head lies on the bone, and both views show the tip in the body."},
        {"Finish the lesson", "", "finish", "What is left in place is judged.",
         "The head lies on the bone, and both views show the tip in the body."}};
  };
  m.field = spine_field;
  m.xray = spine_xray;
  m.shots = spine_shots;
  return m;
}

}  // namespace trephine::lessons
