// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/spine/finder.h"

#include <nlohmann/json.hpp>

#include "lessons/lesson_parts.h"
#include "lessons/spine/spine_critical.h"
#include "lessons/spine/spine_moves.h"
#include "lessons/spine/spine_report.h"
#include "lessons/spine/spine_scan.h"

namespace trephine::lessons {

haptics::BeltToolParams finder_tool() {
  haptics::BeltToolParams finder;
  finder.name = "finder";
  finder.tool = "jamshidi";
  finder.tool_diameter_mm = 4;
  finder.tool_length_mm = 80;
  finder.pierce_n = 2;  // ours: less than a needle's, for it comes from the exposed bone
  return finder;
}

void set_five_errors_lesson(LessonType& m, JudgedTool judged) {
  const bool of_screw = judged == JudgedTool::screw;
  const std::string tool = of_screw ? "screw" : "finder";
  m.columns = {measured_for("entry", "coronal_entry_off_mm"),
               measured_for("axial", "axial_off_deg"),
               measured_for("sagittal", "sagittal_off_deg"),
               measured_for("length", "tip_beyond_target_mm"),
               measured_for("breach", "breach_mm"),
               measured_for("exposure", "exposure_s"),
               measured_for("time", "procedure_s"),
               {"errors_count", "of the five", ""},
               {"acceptable", "1 or 0: not more errors than the rubric allows", ""}};
  for (const char* size : {"length", "diameter"})
    if (of_screw) m.columns.push_back({"screw_" + std::string(size) + "_mm", "of the screw in place; 0: none", ""});
  for (const char* wall : {"medial", "lateral", "upper", "lower"})
    m.columns.push_back(
        {std::string(wall) + "_wall_mm", "how far the " + tool + " in place stands beyond that wall", ""});
  m.columns.push_back({"gertzbein_grade", "of the " + tool + " in place by Gertzbein and Robbins: 0 (A) to 4 (E)", ""});
  m.columns.push_back({"passes_count", "how often " + (of_screw ? "a tool" : "the " + tool) + " entered bone", ""});
  m.columns.push_back({"shots_count", "how often X-rays were on", ""});
  m.outcome = [tool](const LessonFacts& facts, const LessonScore& score) {
    const texts::Phrase unseen = unseen_in_scan(static_cast<const SpineNeedleFacts&>(facts));
    if (!unseen.empty()) return unseen;
    const bool graded = score.known("gertzbein_grade");
    return texts::Phrase("passes: {}, errors: {}, {}, grade {}",
                         {facts.from_scan ? "not judged" : std::to_string(score.count("passes_count")),
                          score.known("errors_count") ? std::to_string(score.count("errors_count")) : "not judged",
                          !score.flag(tool + "_in_bone") ? "no " + tool + " lies in bone"
                          : !score.known("acceptable")   ? "the pedicle is doubtful"
                          : score.flag("acceptable")     ? "acceptable"
                                                         : "not acceptable",
                          graded ? std::string(1, char('A' + score.count("gertzbein_grade"))) : "not judged"});
  };
  m.headline = [of_screw](const LessonFacts&, const LessonScore& score) {
    return texts::Phrase(of_screw ? "errors of the screw: {}" : "errors of the finder: {}",
                         {score.known("errors_count") ? std::to_string(score.count("errors_count")) : "not judged"});
  };
  m.steps = spine_steps();
  m.require = [](const cases::CaseManifest& manifest) { spine_bone_of(manifest); };
  m.plan = plan_spine_moves;
  m.begin = [](const cases::CaseManifest& manifest, const voxel::HapticVolume&, const voxel::HapticVolume&) {
    return std::unique_ptr<Lesson>(std::make_unique<SpineNeedle>(manifest));
  };
  m.facts_json = spine_facts_json;
  m.pictures = spine_pictures;
  m.status = spine_status;
  m.field = spine_field;
  m.xray = spine_xray;
  m.second_takes_xrays = true;
  m.shots = spine_shots;
}

LessonGuide finder_guide() {
  return {"Pass the finder through the pedicle", "finder", "",
          "A finder follows the soft middle of the pedicle, and makes the way that the screw takes.",
          "Even resistance all the way: a sudden give is a wall."};
}

std::vector<LessonText> finder_words() {
  return {{"Pass the finder through the pedicle", "Pfriem durch den Pedikel führen"},
          {"A finder follows the soft middle of the pedicle, and makes the way that the screw takes.",
           "Der Pfriem folgt der weichen Mitte des Pedikels und macht den Weg, den die Schraube nimmt."},
          {"Even resistance all the way: a sudden give is a wall.",
           "Gleichmäßiger Widerstand auf dem ganzen Weg: ein plötzliches Nachgeben ist eine Wand."}};
}

}  // namespace trephine::lessons
