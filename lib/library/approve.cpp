// SPDX-License-Identifier: GPL-3.0-or-later
#include "library/approve.h"

#include <memory>

#include "cases/load_case.h"
#include "lesson/approval.h"
#include "publish/case_lock.h"

namespace trephine::library {
namespace {

// No run may publish another case in between. The lock's file would stay in a folder that is no case.
std::unique_ptr<publish::CaseLock> lock_of(const std::filesystem::path& folder) {
  if (!std::filesystem::exists(folder / "case.json")) return nullptr;
  return std::make_unique<publish::CaseLock>(folder);
}

}  // namespace

std::string approve_case(const std::filesystem::path& case_folder, const std::string& by, int difficulty_level) {
  lesson::validate_token(by, "--by");
  const auto lock = lock_of(case_folder);
  const cases::LoadedCase loaded = cases::load_case(case_folder, cases::whole_case);
  lesson::write_approval(case_folder, by, difficulty_level);
  return loaded.manifest.case_token + ": approved by " + by + ", difficulty " + std::to_string(difficulty_level);
}

std::string withdraw_approval(const std::filesystem::path& case_folder, const std::string& by) {
  lesson::validate_token(by, "--by");
  const auto lock = lock_of(case_folder);
  return case_folder.string() + (lesson::remove_approval(case_folder) ? ": no longer approved" : ": was not approved");
}

}  // namespace trephine::library
