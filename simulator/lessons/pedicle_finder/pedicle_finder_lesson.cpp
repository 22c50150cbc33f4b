// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/pedicle_finder/pedicle_finder_rubric.h"
#include "lessons/spine/finder.h"
#include "lessons/spine/five_errors_score.h"
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
  set_five_errors_lesson(m);
  for (const char* wall : {"medial", "lateral", "upper", "lower"})
    m.columns.push_back({std::string(wall) + "_wall_mm", "how far the finder in place stands beyond that wall", ""});
  m.columns.push_back({"gertzbein_grade", "of the finder in place by Gertzbein and Robbins: 0 (A) to 4 (E)", ""});
  m.columns.push_back({"passes_count", "how often the finder entered bone", ""});
  m.columns.push_back({"shots_count", "how often X-rays were on", ""});
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
  m.outcome = [](const LessonFacts&, const LessonScore& score) {
    const bool graded = score.known("gertzbein_grade");
    return texts::Phrase("passes: {}, errors: {}, {}, grade {}",
                         {std::to_string(score.count("passes_count")),
                          score.known("errors_count") ? std::to_string(score.count("errors_count")) : "not judged",
                          !score.flag("finder_in_bone") ? "no finder lies in bone"
                          : !score.known("acceptable")  ? "the pedicle is doubtful"
                          : score.flag("acceptable")    ? "acceptable"
                                                        : "not acceptable",
                          graded ? std::string(1, char('A' + score.count("gertzbein_grade"))) : "not judged"});
  };
  m.headline = [](const LessonFacts&, const LessonScore& score) {
    return texts::Phrase("errors of the finder: {}",
                         {score.known("errors_count") ? std::to_string(score.count("errors_count")) : "not judged"});
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
