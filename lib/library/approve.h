// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "lesson/approval.h"

namespace trephine::library {

/// Approves a case for lessons (lesson/approval.h), or takes the approval back, under the case's lock: what is approved
/// is what was checked, as a simulator checks it. Where the simulator says of a lesson that the case cannot serve,
/// `accepted` must hold that lesson and why the case is approved all the same. Returns what was done, in words, after
/// the case's token or folder. Throws Error 80 naming the lessons that are not accepted, 64 where `by` is no token, or
/// a lesson is accepted without a reason or for nothing; what load_case and lesson_uses throw, 75 where a run holds the
/// case, 73 and 74.
std::string approve_case(const std::filesystem::path& case_folder, const std::string& by, int difficulty_level,
                         const std::vector<lesson::AcceptedLesson>& accepted = {});
std::string withdraw_approval(const std::filesystem::path& case_folder, const std::string& by);

}  // namespace trephine::library
