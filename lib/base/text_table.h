// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace trephine {

/// Rows of cells, as many in each, as lines with the columns two blanks apart. `alignment` has 'l' or 'r' for each
/// column; its last letter holds for all further ones. No line ends in blanks. Widths are counted in bytes.
std::string text_table(const std::vector<std::vector<std::string>>& rows, std::string_view alignment);

}  // namespace trephine
