// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <string_view>

namespace trephine {

/// As `printable` (base/text.h), of a text of several lines: ends of lines and tabs remain.
std::string printable_lines(std::string_view text);

}  // namespace trephine
