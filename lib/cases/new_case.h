// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>

namespace trephine::cases {

/// A case that is not there yet is written beside its place, in a hidden folder, and appears by one rename: whoever
/// finds LIBRARY/NAME finds all of it. A case that is there is replaced in its place, case.json last (cases/case.h).

/// Whether a case can appear there by a rename: nothing is there, or an empty folder.
bool is_free_for_case(const std::filesystem::path& case_folder);
/// Where it is made: LIBRARY/.NAME.new. A run that was killed leaves it; the next one, and `library gc`, remove it.
std::filesystem::path new_case_folder(const std::filesystem::path& case_folder);
bool is_new_case_folder(const std::string& name);
/// The rename, durable as the files within are. Throws Error 74; then the case is not there.
void let_case_appear(const std::filesystem::path& made_in, const std::filesystem::path& case_folder);

}  // namespace trephine::cases
