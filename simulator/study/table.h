// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace trephine::study {

/// A table of text: what a study reads.
struct Table {
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;  ///< with a cell for each column
  std::vector<std::size_t> lines;              ///< of the file, where each row begins; from 1
  std::optional<std::size_t> column(const std::string& name) const;
};

/// CSV as RFC 4180 has it: commas, a line of names first, quotes where a cell holds a comma, a quote or a line's end.
/// Cells are trimmed; empty lines are passed over. Throws Error 65 naming the line where a row has another count of
/// cells, a quote is not closed, a name is missing, given twice or no plain word. No message repeats a cell, which
/// might be a name.
Table parse_table(std::string_view text);
/// Throws as parse_table, and 66.
Table read_table(const std::filesystem::path& file);

/// The columns of `more` beside those of the table, by the values of the key column; empty where `more` has no row of
/// that key. Throws Error 65 where a key stands twice in `more`, or both have a column of one name.
Table joined(const Table& table, const Table& more, const std::string& key);

/// CSV of it, with quotes where they are needed.
std::string table_csv(const Table& table);

/// Whether the cell says that there is no value: empty, or NA as R writes it.
inline bool is_missing(std::string_view cell) { return cell.empty() || cell == "NA"; }

}  // namespace trephine::study
