// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/table.h"

#include <algorithm>
#include <map>

#include "base/error.h"
#include "base/text.h"
#include "base/write_file.h"

namespace trephine::study {
namespace {

constexpr std::size_t max_cells = 20'000'000;

[[noreturn]] void fault(std::size_t line, const std::string& what) {
  throw Error(ExitCode::bad_input, "", "line " + std::to_string(line), what);
}

// One record after the other, with the line on which it began.
class Records {
 public:
  explicit Records(std::string_view text) : text_(text) {
    if (text_.substr(0, 3) == "\xEF\xBB\xBF") text_.remove_prefix(3);
  }
  bool next(std::vector<std::string>& cells, std::size_t& line) {
    while (at_ < text_.size()) {
      cells.clear();
      line = line_;
      read(cells);
      if (cells.size() > 1 || !cells.front().empty()) return true;
    }
    return false;
  }

 private:
  void read(std::vector<std::string>& cells) {
    for (;;) {
      cells.push_back(cell());
      if (at_ >= text_.size()) return;
      if (text_[at_++] == ',') continue;
      ++line_;
      return;
    }
  }
  // Up to the comma or line's end behind it.
  std::string cell() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t')) ++at_;
    if (at_ >= text_.size() || text_[at_] != '"') {
      const std::size_t end = std::min(text_.find_first_of(",\n", at_), text_.size());
      const std::string plain = trimmed(text_.substr(at_, end - at_));
      if (plain.find('"') != std::string::npos)
        fault(line_, "holds a quote within a cell that does not begin with one");
      at_ = end;
      return plain;
    }
    const std::size_t begun = line_;
    std::string out;
    for (++at_;; ++at_) {
      if (at_ >= text_.size()) fault(begun, "has a quote that is not closed");
      if (text_[at_] == '\n') ++line_;
      if (text_[at_] != '"') {
        out += text_[at_];
      } else if (at_ + 1 < text_.size() && text_[at_ + 1] == '"') {
        out += text_[++at_];
      } else {
        break;
      }
    }
    ++at_;
    const std::size_t end = std::min(text_.find_first_of(",\n", at_), text_.size());
    if (!trimmed(text_.substr(at_, end - at_)).empty()) fault(line_, "goes on behind a cell's closing quote");
    at_ = end;
    return trimmed(out);
  }

  std::string_view text_;
  std::size_t at_ = 0, line_ = 1;
};

void check_names(const std::vector<std::string>& names, std::size_t line) {
  for (std::size_t n = 0; n < names.size(); ++n) {
    const std::string& name = names[n];
    const bool plain = !name.empty() && name.size() <= 64 && std::all_of(name.begin(), name.end(), [](char c) {
      return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-' ||
             c == '.';
    });
    if (!plain)
      fault(line, "the name of column " + std::to_string(n + 1) +
                      " must be 1 to 64 of a-z, A-Z, 0-9, _ - and . (a file that is parted by semicolons must be saved "
                      "with commas)");
    if (std::find(names.begin(), names.begin() + std::ptrdiff_t(n), name) != names.begin() + std::ptrdiff_t(n))
      fault(line, "column " + name + " is named twice");
  }
}

}  // namespace

std::optional<std::size_t> Table::column(const std::string& name) const {
  const auto at = std::find(columns.begin(), columns.end(), name);
  if (at == columns.end()) return std::nullopt;
  return std::size_t(at - columns.begin());
}

Table parse_table(std::string_view text) {
  Table table;
  Records records(text);
  std::size_t line = 1;
  if (!records.next(table.columns, line)) throw Error(ExitCode::bad_input, "", "", "is empty");
  check_names(table.columns, line);
  std::vector<std::string> cells;
  while (records.next(cells, line)) {
    if (cells.size() != table.columns.size())
      fault(line, "has " + std::to_string(cells.size()) + " cells, the first line names " +
                      std::to_string(table.columns.size()) + " columns");
    if ((table.rows.size() + 1) * table.columns.size() > max_cells)
      fault(line, "the table has more than " + std::to_string(max_cells) + " cells");
    table.rows.push_back(cells);
    table.lines.push_back(line);
  }
  return table;
}

Table read_table(const std::filesystem::path& file) {
  return with_file(file.string(), [&] {
    const std::vector<char> bytes = read_file(file, 1 << 28);
    return parse_table({bytes.data(), bytes.size()});
  });
}

Table joined(const Table& table, const Table& more, const std::string& key) {
  const std::optional<std::size_t> here = table.column(key), there = more.column(key);
  if (!here || !there) throw Error(ExitCode::bad_input, "", key, "is no column of both tables");
  std::map<std::string, std::size_t> rows;
  for (std::size_t n = 0; n < more.rows.size(); ++n)
    if (!rows.emplace(more.rows[n][*there], n).second) fault(more.lines[n], "its " + key + " stood before");
  Table out = table;
  for (std::size_t c = 0; c < more.columns.size(); ++c) {
    if (c == *there) continue;
    if (table.column(more.columns[c]))
      throw Error(ExitCode::bad_input, "", more.columns[c], "is a column of both tables");
    out.columns.push_back(more.columns[c]);
    for (std::vector<std::string>& row : out.rows) {
      const auto at = rows.find(row[*here]);
      row.push_back(at == rows.end() ? "" : more.rows[at->second][c]);
    }
  }
  return out;
}

std::string table_csv(const Table& table) {
  std::string out;
  const auto add = [&](const std::vector<std::string>& cells) {
    for (std::size_t n = 0; n < cells.size(); ++n) {
      if (n > 0) out += ',';
      if (cells[n].find_first_of(",\"\n\r") == std::string::npos) {
        out += cells[n];
        continue;
      }
      out += '"';
      for (const char c : cells[n]) out += c == '"' ? std::string("\"\"") : std::string(1, c);
      out += '"';
    }
    out += '\n';
  };
  add(table.columns);
  for (const auto& row : table.rows) add(row);
  return out;
}

}  // namespace trephine::study
