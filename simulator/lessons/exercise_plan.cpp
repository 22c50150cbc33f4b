// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/exercise_plan.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"
#include "base/write_file.h"
#include "json/declared_json.h"

namespace trephine::lessons {

namespace fs = std::filesystem;

fs::path plan_file(const fs::path& folder, const std::string& participant, const std::string& module) {
  return folder / (participant + "-" + module + ".plan.json");
}

fs::path planned_file(const fs::path& folder, const ExercisePlan& plan, std::size_t n, const char* extension) {
  return folder / fmt::format("{}-{}-{:02}-{}{}", plan.participant, plan.module, n + 1, plan.cases[n].token, extension);
}

std::vector<PlannedCase> phased(const std::vector<PlannedCase>& chosen, const CurriculumParams& params) {
  const std::size_t tests = std::size_t(params.test_cases_count), count = chosen.size();
  if (tests > count)
    throw Error(ExitCode::usage, "", "--test-cases-count",
                fmt::format("{} are to be withheld, and {} can be exercised", tests, count));
  std::vector<bool> withheld(count);
  for (std::size_t n = 0; n < tests; ++n) withheld[(2 * n + 1) * count / (2 * tests)] = true;
  std::vector<PlannedCase> plan;
  const auto add = [&](bool test, const char* phase) {
    for (std::size_t n = 0; n < count; ++n)
      if (withheld[n] == test) {
        plan.push_back(chosen[n]);
        plan.back().phase = tests > 0 ? phase : "";
      }
  };
  add(true, "before");
  for (int round = 0; round < params.rounds_count; ++round) add(false, "practice");
  add(true, "after");
  return plan;
}

void add_round(ExercisePlan& plan, std::size_t done) {
  std::vector<PlannedCase> round;
  for (const PlannedCase& c : plan.cases) {
    const bool there = std::any_of(round.begin(), round.end(),
                                   [&](const PlannedCase& r) { return r.token == c.token && r.task == c.task; });
    if ((c.phase.empty() || c.phase == "practice") && !there) round.push_back(c);
  }
  const auto after = std::find_if(plan.cases.begin(), plan.cases.end(),
                                  [](const PlannedCase& c) { return c.phase == "after" || c.phase == "retention"; });
  plan.cases.insert(std::size_t(after - plan.cases.begin()) >= done ? after : plan.cases.end(), round.begin(),
                    round.end());
}

void add_retention(ExercisePlan& plan) {
  std::vector<PlannedCase> tests;
  for (const PlannedCase& c : plan.cases)
    if (c.phase == "after") tests.push_back(c);
  if (tests.empty()) throw Error(ExitCode::usage, "", "--retention", "the plan has no tests (--test-cases-count)");
  for (PlannedCase& c : tests) {
    c.phase = "retention";
    plan.cases.push_back(c);
  }
}

ExercisePlan read_plan(const fs::path& file) {
  ExercisePlan plan;
  with_file(file.string(), [&] {
    const std::vector<char> bytes = read_file(file, 1 << 20);
    json::read_declared_json({bytes.data(), bytes.size()}, parameters_of<ExercisePlan>(), &plan);
    for (const PlannedCase& c : plan.cases) cases::validate_case_token(c.token, ExitCode::bad_input);
  });
  return plan;
}

void write_plan(const fs::path& file, const ExercisePlan& plan) {
  write_file(file, json::declared_json(AnyParams::make<ExercisePlan>(plan)) + "\n");
}

}  // namespace trephine::lessons
