// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace trephine {

/// Writes numbers as text, whatever the locale is (std::to_chars, from_chars), in the shortest form that reads back to
/// the same value.
std::string to_text(double v);
/// Writes 80000 as "80,000".
std::string grouped_text(long long number);
/// Reads one finite decimal number, which must be the whole text ("1e-3" is allowed; "010", "0x8", ".nan", "1,5" and "
/// 1" are not).
std::optional<double> parse_number(std::string_view text);
std::optional<long long> parse_integer(std::string_view text);

/// The text without blanks, tabs and carriage returns at either end.
std::string trimmed(std::string_view text);

/// The pieces between the separators: n separators give n + 1 pieces, which may be empty.
std::vector<std::string> split_at(std::string_view text, char separator);

/// The text with every control character (C0, DEL, C1) replaced by '?', so that it stays one line and cannot control
/// the terminal.
std::string printable(std::string_view text);

/// The name nearest to `name` by edit distance, or empty where none is near enough to be a typing error.
std::string nearest_name(std::string_view name, const std::vector<std::string>& known);

}  // namespace trephine
