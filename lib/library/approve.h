// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>

namespace trephine::library {

/// Approves a case for lessons (lesson/approval.h), or takes the approval back, under the case's lock: what is approved
/// is what was checked, as a simulator checks it. Returns what was done, in words, after the case's token or folder.
/// Throws Error 64 where `by` is no token, what load_case throws, 75 where a run holds the case, 73 and 74.
std::string approve_case(const std::filesystem::path& case_folder, const std::string& by, int difficulty_level);
std::string withdraw_approval(const std::filesystem::path& case_folder, const std::string& by);

}  // namespace trephine::library
