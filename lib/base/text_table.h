// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace trephine {

/// Formats rows of cells, with equally many cells in each row, as lines whose columns are two blanks apart. `alignment`
/// has 'l' or 'r' for each column; its last letter holds for all further columns. No line ends in blanks. Widths are
/// counted in bytes.
std::string text_table(const std::vector<std::vector<std::string>>& rows, std::string_view alignment);

}  // namespace trephine
