// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "lessons/curriculum.h"

namespace trephine::lessons {

/// A case of a participant's plan. Keys that came later are empty in older plans.
struct PlannedCase {
  std::string token, patient_class, task, phase;
  int difficulty_level = 3;
  template <class V>
  static void describe(V& v) {
    using P = PlannedCase;
    v.text(&P::token, "case", "The case's token.").is_required();
    v.text(&P::patient_class, "class", "The patient's class.").is_required();
    v.integer(&P::difficulty_level, "difficulty_level", Range{1, 5}, "How difficult.").is_required();
    v.text(&P::task, "task", "What is asked for.");
    v.text(&P::phase, "phase", "before, practice, after or retention; empty: the plan has no phases.");
  }
};

/// The plan as it lies in the results' folder, so that it stays the same when the library grows.
struct ExercisePlan {
  int trephine_exercise = 1;
  std::string participant, module, group, level;
  CurriculumParams curriculum;
  std::vector<PlannedCase> cases;
  template <class V>
  static void describe(V& v) {
    using P = ExercisePlan;
    v.integer(&P::trephine_exercise, "trephine_exercise", Range{1, 1}, "The version of the format: 1.").is_required();
    v.text(&P::participant, "participant", "Who does it.").is_required();
    v.text(&P::module, "module", "Which lesson.").is_required();
    v.text(&P::group, "group", "The group of a study.");
    v.text(&P::level, "level", "The level of training.");
    v.group(&P::curriculum, "curriculum", "By what the cases were chosen.").is_required();
    v.list(&P::cases, "cases", "The cases in their order.").is_required();
  }
};

/// Files of a participant's plan: FOLDER/PARTICIPANT-MODULE.plan.json, and beside it, for case n (from 0) of the plan,
/// PARTICIPANT-MODULE-NN-CASE and an extension.
std::filesystem::path plan_file(const std::filesystem::path& folder, const std::string& participant,
                                const std::string& module);
std::filesystem::path planned_file(const std::filesystem::path& folder, const ExercisePlan& plan, std::size_t n,
                                   const char* extension);

/// The cases in the order in which they are done, with their phases: the tests before, the practice as often as there
/// are rounds, the same tests after. The withheld ones are spread evenly over the order. Without tests no case has a
/// phase. Throws Error 64 where more are withheld than there are.
std::vector<PlannedCase> phased(const std::vector<PlannedCase>& chosen, const CurriculumParams& params);
/// Once more through the practice: before the tests that come after it, where none of them is `done` yet, else at the
/// end. `done` counts the cases of the plan from its begin up to the last one that is done.
void add_round(ExercisePlan& plan, std::size_t done);
/// The tests once more, at the end, as phase retention. Throws Error 64 where the plan has no tests.
void add_retention(ExercisePlan& plan);

/// Throws Error 65, 66. The tokens of its cases can be parts of file names.
ExercisePlan read_plan(const std::filesystem::path& file);
void write_plan(const std::filesystem::path& file, const ExercisePlan& plan);

}  // namespace trephine::lessons
