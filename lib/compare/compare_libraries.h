// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "compare/compare_cases.h"

namespace trephine::compare {

/// One case of two libraries.
struct LibraryCaseChange {
  std::string token;
  InCases in = InCases::both;
  std::string fault;  ///< why the two could not be compared: the error's line; empty where they were
  CaseComparison comparison;
};

/// Whether the folder is no case but holds folders that are.
bool is_library(const std::filesystem::path& folder);

/// Compares the cases of the same token, one pair after the other; a pair that cannot be read is told and does not stop
/// the others. In the order of the tokens. Throws Cancelled.
std::vector<LibraryCaseChange> compare_libraries(const std::filesystem::path& old_library,
                                                 const std::filesystem::path& new_library,
                                                 const CompareParams& params = {}, const Progress& progress = {});

/// beyond_limits of all, with the case's token before each. With any limit, a case that is in one library only, or
/// could not be compared, exceeds it.
std::vector<std::string> beyond_limits(const std::vector<LibraryCaseChange>& cases, const CompareParams& params);

/// A line for each case: the anatomy that deviates most, the volume that changed most, the point that moved most, the
/// class; and as JSON {"cases": [{"case", "in", "fault" or "comparison" as comparison_json writes it}]}.
std::string libraries_text(const std::vector<LibraryCaseChange>& cases);
std::string libraries_json(const std::vector<LibraryCaseChange>& cases);

}  // namespace trephine::compare
