// SPDX-License-Identifier: GPL-3.0-or-later
#include "library/approve.h"

#include <algorithm>
#include <memory>

#include "base/refusal.h"
#include "cases/load_hashed.h"
#include "library/lesson_uses.h"
#include "publish/case_lock.h"

namespace trephine::library {
namespace {

// No run may publish another case in between. The lock's file would stay in a folder that is no case.
std::unique_ptr<publish::CaseLock> lock_of(const std::filesystem::path& folder) {
  if (!std::filesystem::exists(folder / "case.json")) return nullptr;
  return std::make_unique<publish::CaseLock>(folder);
}

bool is_blank(const std::string& text) { return text.find_first_not_of(" \t\r\n") == std::string::npos; }

// Of each lesson that the case cannot serve somebody must have said why that is right.
void require_accepted(const std::vector<LessonUse>& uses, const std::vector<lesson::AcceptedLesson>& accepted) {
  for (const lesson::AcceptedLesson& a : accepted) {
    const auto use = std::find_if(uses.begin(), uses.end(), [&](const LessonUse& u) { return u.name == a.lesson; });
    if (use == uses.end()) throw Error(ExitCode::usage, "", "--accept", a.lesson + ", there is no such lesson");
    if (use->why_not.empty())
      throw Error(ExitCode::usage, "", "--accept", a.lesson + ": the case can serve that lesson, leave it out");
    if (is_blank(a.reason)) throw Error(ExitCode::usage, "", "--accept", a.lesson + ": the reason is missing");
  }
  std::string open;
  for (const LessonUse& use : uses)
    if (!use.why_not.empty() &&
        std::none_of(accepted.begin(), accepted.end(), [&](const auto& a) { return a.lesson == use.name; }))
      open += (open.empty() ? "" : ",") + use.name;
  if (!open.empty())
    throw refusal("--accept", "the case cannot serve " + open,
                  {"where that is right, say why by `accept`: --accept '" + open + "=REASON'"});
}

}  // namespace

std::string approve_case(const std::filesystem::path& case_folder, const std::string& by, int difficulty_level,
                         const std::vector<lesson::AcceptedLesson>& accepted) {
  lesson::validate_token(by, "--by");
  const auto lock = lock_of(case_folder);
  const cases::HashedCase checked = cases::load_hashed_case(case_folder, cases::whole_case);
  if (const auto uses = lesson_uses(case_folder, checked.sha256)) require_accepted(*uses, accepted);
  lesson::write_approval(case_folder, checked.sha256, by, difficulty_level, accepted);
  return checked.loaded.manifest.case_token + ": approved by " + by + ", difficulty " +
         std::to_string(difficulty_level);
}

std::string withdraw_approval(const std::filesystem::path& case_folder, const std::string& by) {
  lesson::validate_token(by, "--by");
  const auto lock = lock_of(case_folder);
  return case_folder.string() + (lesson::remove_approval(case_folder) ? ": no longer approved" : ": was not approved");
}

}  // namespace trephine::library
