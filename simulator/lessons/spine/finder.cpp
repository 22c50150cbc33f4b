// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/spine/finder.h"

#include <nlohmann/json.hpp>

#include "lessons/spine/spine_critical.h"
#include "lessons/spine/spine_moves.h"
#include "lessons/spine/spine_report.h"

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

void set_five_errors_lesson(LessonType& m) {
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
