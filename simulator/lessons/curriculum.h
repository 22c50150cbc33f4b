// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/params.h"
#include "lessons/lesson_type.h"

namespace trephine::lessons {

/// Which cases of a library a participant exercises on, and in what order.
struct CurriculumParams {
  enum class Order { difficulty, random };
  int cases_count = 6;
  std::string classes = "normal,hydrocephalic,shifted,small", task;
  int least_difficulty_level = 1, most_difficulty_level = 5;
  Order order = Order::difficulty;
  std::int64_t order_seed = 1;
  int test_cases_count = 0, rounds_count = 1;
  template <class V>
  static void describe(V& v) {
    using P = CurriculumParams;
    v.integer(&P::cases_count, "cases_count", Range{1, 1000}, "How many cases, at most.");
    v.text(&P::classes, "classes",
           "Classes of patients, which take turns in this order; never uncertain. "
           "Ignored where the lesson has no classes.");
    v.text(&P::task, "task",
           "What is asked for in every case, as `left`; drawn: by the seed; empty: what is usual in the case.");
    v.integer(&P::least_difficulty_level, "least_difficulty_level", Range{1, 5}, "The easiest that is taken.");
    v.integer(&P::most_difficulty_level, "most_difficulty_level", Range{1, 5}, "The hardest that is taken.");
    v.choice(&P::order, "order", {{"difficulty", Order::difficulty}, {"random", Order::random}},
             "Within a class: the easier ones first, of equals by the seed; or all by the seed.");
    v.integer(&P::order_seed, "order_seed", Range{0, 1e9},
              "Of what is left to chance; the same seed gives the same order.");
    v.integer(&P::test_cases_count, "test_cases_count", Range{0, 1000},
              "So many of the cases are withheld for the tests before and after practice, and are not practised; 0: "
              "there are no tests.");
    v.integer(&P::rounds_count, "rounds_count", Range{1, 100}, "How often each case that is practised is done.");
  }
};

struct CurriculumCase {
  std::string token, patient_class, approved_by;
  std::string case_sha256;         ///< of the case.json that is approved
  std::vector<std::string> tasks;  ///< the usual one first
  int difficulty_level = 3;
  std::filesystem::path folder;
};

/// What a library holds for lessons, and what it holds beside, with the reason of each.
struct LibraryCases {
  std::vector<CurriculumCase> approved;                       ///< by token
  std::vector<std::pair<std::string, std::string>> left_out;  ///< folder, why
  int of_other_lessons = 0;  ///< cases that cannot serve this lesson, and serve another
};

/// Reads case.json and the approval of every case of the library. A case is left out that is not approved, whose
/// approval is void or damaged, that holds no such lesson, or, where the lesson has classes, whose class is uncertain
/// or not known. Throws Error 66 where the folder cannot be listed.
LibraryCases cases_for_lessons(const std::filesystem::path& library, const LessonType& module);

/// Throws Error 80 where the case that was loaded is not the one of that hash, which a reviewer approved.
void require_approved(const std::filesystem::path& case_folder, const std::string& case_sha256,
                      const std::string& approved_sha256);

/// What is asked for in the case; empty where it holds no task. Throws Error 64 where it does not hold the task that is
/// named.
std::string assigned_task(const CurriculumCase& one, const CurriculumParams& params);

/// Pure: the same cases and parameters give the same plan. The classes take turns. Throws Error 64 for a class that is
/// named twice, unknown, or uncertain; and limits of difficulty that cross.
/// A lesson without classes has one list.
std::vector<CurriculumCase> plan_curriculum(const std::vector<CurriculumCase>& cases, const CurriculumParams& params,
                                            const LessonType& module);

}  // namespace trephine::lessons
