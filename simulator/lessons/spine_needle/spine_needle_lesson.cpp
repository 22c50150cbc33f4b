// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "lessons/lesson_parts.h"
#include "lessons/spine/spine_critical.h"
#include "lessons/spine/spine_moves.h"
#include "lessons/spine/spine_report.h"
#include "lessons/spine/spine_scan.h"
#include "lessons/spine_needle/spine_needle_score.h"

namespace trephine::lessons {
namespace {

// The tool of [Rizzi, chapter 7.2]: a Jamshidi needle, which is pushed through bone. Its pedal is the C-arm's.
std::vector<haptics::BeltToolParams> spine_needle_tools() {
  haptics::BeltToolParams needle;
  needle.name = "needle";
  needle.tool = "jamshidi";
  static_cast<haptics::ToolParams&>(needle) = haptics::own_tool(needle);
  needle.pierce_n = 2.5;
  return {needle};
}

const SpineNeedleFacts& own(const LessonFacts& facts) { return static_cast<const SpineNeedleFacts&>(facts); }
texts::Phrase outcome(const LessonFacts& facts, const LessonScore& score) {
  if (const texts::Phrase unseen = unseen_in_scan(own(facts), true); !unseen.empty()) return unseen;
  if (facts.from_scan) return score.flag("in_bone") ? "the needle lies in bone" : "the needle lies in no bone";
  return {"needle passes: {}, exposure {} s in {} shots, {}",
          {std::to_string(score.count("passes_count")), fmt::format("{:.1f}", own(facts).exposure_s()),
           std::to_string(score.count("shots_count")),
           score.flag("in_bone") ? "the needle lies in bone" : "the needle lies in no bone"}};
}

}  // namespace

LessonType spine_needle_lesson() {
  LessonType m;
  m.name = "spine_needle";
  m.german_title = "Nadel durch den Pedikel";
  m.summary = "a Jamshidi needle through a pedicle, under fluoroscopy";
  m.rows = {"entry", "target", "breach", "depth", "exposure", "passes", "time"};
  m.columns = {measured_for("entry", "entry_off_mm"),
               measured_for("target", "target_off_mm"),
               measured_for("breach", "breach_mm"),
               measured_for("depth", "depth_beyond_target_mm"),
               measured_for("exposure", "exposure_s"),
               measured_for("time", "procedure_s"),
               {"passes_count", "how often the needle entered bone", ""},
               {"shots_count", "how often X-rays were on", ""},
               {"in_bone", "1 or 0: the needle is left in bone at the end, wherever its tip is", ""},
               {"breached", "1 or 0: it came through the pedicle's wall", ""},
               {"medial", "1 or 0: towards the canal, where the breach was deepest", ""},
               {"turned_deg", "angle between the needle and the ideal axis", ""}};
  m.steps = spine_steps();
  m.require = [](const cases::CaseManifest& manifest) { spine_bone_of(manifest); };
  m.tools = spine_needle_tools;
  m.tasks = [](const cases::CaseManifest& manifest) {
    std::vector<LessonTask> all;
    for (const std::string& name : pedicle_tasks(manifest))
      all.push_back({name,
                     "A Jamshidi needle from the skin through " + pedicle_in_words(name) +
                         ": its tip in the front half of the body, within the bone all the way.",
                     "A biopsy of the vertebral body, or the way for a wire, a screw or cement.",
                     "Eine Jamshidi-Nadel von der Haut durch " + pedicle_in_words(name, true) +
                         ": die Spitze in der vorderen Hälfte des Wirbelkörpers, auf dem ganzen Weg im Knochen.",
                     "Eine Biopsie des Wirbelkörpers, oder der Weg für einen Draht, eine Schraube oder Zement.",
                     pedicle_doubt(manifest, name)});
    return all;
  };
  m.plan = plan_spine_moves;
  m.begin = [](const cases::CaseManifest& manifest, const voxel::HapticVolume&, const voxel::HapticVolume&) {
    return std::unique_ptr<Lesson>(std::make_unique<SpineNeedle>(manifest));
  };
  m.needs_pictures = true;
  m.score = [](const LessonFacts& facts, const cases::LoadedCase& loaded, const voxel::HapticVolume& before,
               const AnyParams& rubric) {
    return score_spine_needle(own(facts), loaded.manifest, before, rubric.as<SpineNeedleRubric>());
  };
  m.facts_json = spine_facts_json;
  m.outcome = outcome;
  m.facts_of_outcome = needle_facts_of_scan;
  m.headline = [](const LessonFacts& facts, const LessonScore& score) {
    if (facts.from_scan) return outcome(facts, score);
    return texts::Phrase("passes of the needle: {} · X-rays {} s",
                         {std::to_string(score.count("passes_count")), fmt::format("{:.1f}", own(facts).exposure_s())});
  };
  m.pictures = spine_pictures;
  m.status = spine_status;
  m.texts = {{"Pass the needle through the pedicle", "Nadel durch den Pedikel führen"},
             {"The pedicle is the only bony way into the body that passes neither canal nor root.",
              "Der Pedikel ist der einzige knöcherne Weg in den Wirbelkörper, an Kanal und Wurzel vorbei."},
             {"AP the tip stays within the pedicle's ring until it is in the body from the side.",
              "A.-p. bleibt die Spitze im Ring des Pedikels, bis sie von der Seite gesehen im Wirbelkörper liegt."},
             {"Both views show the tip in the body.", "In beiden Ansichten liegt die Spitze im Wirbelkörper."}};
  append(m.texts, spine_words());
  m.guide = [](const LessonFacts&) {
    return std::vector<LessonGuide>{
        {"Pass the needle through the pedicle", "needle", "",
         "The pedicle is the only bony way into the body that passes neither canal nor root.",
         "AP the tip stays within the pedicle's ring until it is in the body from the side."},
        {"Finish the lesson", "", "finish", "What is left in place is judged.",
         "Both views show the tip in the body."}};
  };
  m.field = spine_field;
  m.xray = spine_xray;
  m.second_takes_xrays = true;
  m.shots = spine_shots;
  return m;
}

}  // namespace trephine::lessons
