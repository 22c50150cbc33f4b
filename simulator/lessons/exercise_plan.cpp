// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/exercise_plan.h"

#include <fmt/format.h>

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
