// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/observations.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <set>

#include "base/error.h"
#include "base/text.h"

namespace trephine::study::detail {
namespace {

constexpr std::size_t max_rows = 1'000'000;

struct Columns {
  std::optional<std::size_t> participant, group, phase, attempt, count, acceptable;
  std::vector<std::size_t> measures;
};

[[noreturn]] void unknown_column(const Table& table, const std::string& parameter, const std::string& name) {
  const std::string near = nearest_name(name, table.columns);
  throw Error(ExitCode::usage, "", parameter,
              printable(name) + " is no column of the table" + (near.empty() ? "" : "; did you mean " + near + "?"));
}

// A column by its name; a standard name may be missing.
std::optional<std::size_t> found(const Table& table, const char* parameter, const std::string& name,
                                 const std::string& standard) {
  const std::optional<std::size_t> at = name.empty() ? std::nullopt : table.column(name);
  if (!at && !name.empty() && name != standard) unknown_column(table, parameter, name);
  return at;
}

// "inf" and "-nan" are meant as numbers, and refused where they are read.
bool is_not_finite(std::string cell) {
  if (!cell.empty() && (cell[0] == '-' || cell[0] == '+')) cell.erase(0, 1);
  for (char& c : cell) c = char(std::tolower(static_cast<unsigned char>(c)));
  return cell == "inf" || cell == "infinity" || cell == "nan";
}

bool are_numbers(const Table& table, std::size_t column) {
  bool some = false;
  for (const auto& row : table.rows) {
    if (is_missing(row[column])) continue;
    if (!parse_number(row[column]) && !is_not_finite(row[column])) return false;
    some = true;
  }
  return some;
}

Columns columns_of(const Table& table, const StudyParams& p, std::vector<std::string>& notes) {
  const StudyParams standard;
  Columns c;
  c.participant = found(table, "participant", p.participant, standard.participant);
  c.group = found(table, "group", p.group, standard.group);
  c.phase = found(table, "phase", p.phase, standard.phase);
  c.attempt = found(table, "attempt", p.attempt, standard.attempt);
  c.count = found(table, "count", p.count, "");
  c.acceptable = found(table, "acceptable", p.acceptable, "");
  if (!p.measures.empty()) {
    for (const std::string& name : split_at(p.measures, ',')) {
      const std::optional<std::size_t> at = table.column(trimmed(name));
      if (!at) unknown_column(table, "measures", trimmed(name));
      if (std::find(c.measures.begin(), c.measures.end(), *at) != c.measures.end())
        throw Error(ExitCode::usage, "", "measures", trimmed(name) + " is named twice");
      c.measures.push_back(*at);
    }
    return c;
  }
  std::string others;
  for (std::size_t n = 0; n < table.columns.size(); ++n) {
    if (n == c.participant || n == c.group || n == c.phase || n == c.attempt || n == c.count || n == c.acceptable)
      continue;
    if (are_numbers(table, n))
      c.measures.push_back(n);
    else
      others += (others.empty() ? "" : ", ") + table.columns[n];
  }
  if (!others.empty()) notes.push_back("no columns of numbers, and so not evaluated: " + others);
  return c;
}

// Rows that --only keeps.
std::vector<std::size_t> kept_rows(const Table& table, const std::string& only) {
  std::vector<std::pair<std::size_t, std::string>> wanted;
  if (!only.empty())
    for (const std::string& one : split_at(only, ',')) {
      const std::size_t is = one.find('=');
      if (is == std::string::npos) throw Error(ExitCode::usage, "", "only", "must be column=value,column=value");
      const std::optional<std::size_t> at = table.column(trimmed(one.substr(0, is)));
      if (!at) unknown_column(table, "only", trimmed(one.substr(0, is)));
      wanted.emplace_back(*at, trimmed(one.substr(is + 1)));
    }
  std::vector<std::size_t> kept;
  for (std::size_t n = 0; n < table.rows.size(); ++n)
    if (std::all_of(wanted.begin(), wanted.end(), [&](const auto& w) { return table.rows[n][w.first] == w.second; }))
      kept.push_back(n);
  return kept;
}

[[noreturn]] void fault(const Table& table, std::size_t row, std::size_t column, const std::string& what) {
  throw Error(ExitCode::bad_input, "", "line " + std::to_string(table.lines[row]) + ", " + table.columns[column], what);
}

bool is_token(const std::string& s) {
  return !s.empty() && s.size() <= 32 && std::all_of(s.begin(), s.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  });
}

// Groups and phases are printed, so they are kept short and plain.
std::string label(const Table& table, std::size_t row, const std::optional<std::size_t>& column) {
  if (!column) return "";
  const std::string& cell = table.rows[row][*column];
  if (cell.size() > 40 || printable(cell) != cell) fault(table, row, *column, "must be at most 40 plain characters");
  return cell;
}

std::vector<std::string> in_order(const std::vector<Observation>& rows, std::string Observation::*of) {
  std::vector<std::string> names;
  for (const Observation& o : rows)
    if (!(o.*of).empty() && std::find(names.begin(), names.end(), o.*of) == names.end()) names.push_back(o.*of);
  // Phases have an order of their own, whichever the table begins with.
  static const std::vector<std::string> known = {"pre", "before", "practice", "post", "after", "retention"};
  const auto rank = [](const std::string& s) { return std::find(known.begin(), known.end(), s); };
  if (std::all_of(names.begin(), names.end(), [&](const auto& s) { return rank(s) != known.end(); }))
    std::stable_sort(names.begin(), names.end(), [&](const auto& a, const auto& b) { return rank(a) < rank(b); });
  return names;
}

void check_groups(const Observations& all) {
  std::map<std::string, std::string> group_of;
  for (const Observation& o : all.rows) {
    if (o.participant.empty() || o.group.empty()) continue;
    const auto at = group_of.emplace(o.participant, o.group).first;
    if (at->second != o.group)
      throw Error(ExitCode::bad_input, "", "line " + std::to_string(o.line),
                  "participant " + o.participant +
                      " is in two groups, which are compared as independent; give what "
                      "differs within participants as --phase, or take rows as independent by --unit row");
  }
}

}  // namespace

std::string some_of(const std::vector<std::string>& names) {
  std::string out;
  const std::size_t shown = names.size() > 12 ? 10 : names.size();
  for (std::size_t n = 0; n < shown; ++n) out += (n == 0 ? "" : ", ") + names[n];
  if (shown < names.size()) out += " and " + std::to_string(names.size() - shown) + " more";
  return out;
}

Observations observations_of(const Table& table, const StudyParams& params) {
  Observations all;
  const Columns columns = columns_of(table, params, all.notes);
  for (const std::size_t c : columns.measures) all.measures.push_back(table.columns[c]);
  all.has_participants = columns.participant.has_value();
  std::vector<std::string> no_group, no_phase, no_attempt;
  const std::vector<std::size_t> kept = kept_rows(table, params.only);
  for (const std::size_t n : kept) {
    const std::vector<std::string>& cells = table.rows[n];
    Observation o;
    o.line = table.lines[n];
    if (columns.participant) {
      o.participant = cells[*columns.participant];
      if (!is_token(o.participant))
        fault(table, n, *columns.participant,
              "must be a token of 1 to 32 characters a-z, 0-9, _ and -, never a name (its text is not repeated here)");
    }
    const std::string line = "line " + std::to_string(o.line);
    o.group = label(table, n, columns.group);
    if (columns.group && is_missing(o.group)) no_group.push_back(line), o.group.clear();
    o.phase = label(table, n, columns.phase);
    if (columns.phase && is_missing(o.phase)) no_phase.push_back(line), o.phase.clear();
    if (columns.attempt && is_missing(cells[*columns.attempt])) {
      no_attempt.push_back(line);
    } else if (columns.attempt) {
      const auto attempt = parse_integer(cells[*columns.attempt]);
      if (!attempt || *attempt < 1 || *attempt > 100000)
        fault(table, n, *columns.attempt, "must be a whole number from 1 to 100000");
      o.attempt = int(*attempt);
    }
    for (const std::size_t c : columns.measures) {
      const std::optional<double> value = is_missing(cells[c]) ? std::nullopt : parse_number(cells[c]);
      if (!value && !is_missing(cells[c]))
        fault(table, n, c, "is no finite number with a decimal point; leave a missing value empty, or write NA");
      o.measures.push_back(value);
    }
    if (columns.acceptable && !is_missing(cells[*columns.acceptable])) {
      const std::string& cell = cells[*columns.acceptable];
      if (cell != "0" && cell != "1") fault(table, n, *columns.acceptable, "must be 1 (acceptable) or 0");
      o.acceptable = cell == "1";
    }
    long long count = 1;
    if (columns.count) {
      const auto given = parse_integer(cells[*columns.count]);
      if (!given || *given < 0 || *given > (long long)max_rows)
        fault(table, n, *columns.count, "must be a whole number from 0 to 1000000");
      count = *given;
    }
    if (all.rows.size() + std::size_t(count) > max_rows)
      fault(table, n, columns.count.value_or(0), "gives more than 1000000 observations");
    all.rows.insert(all.rows.end(), std::size_t(count), o);
  }
  if (kept.size() < table.rows.size())
    all.notes.push_back(std::to_string(table.rows.size() - kept.size()) + " of " + std::to_string(table.rows.size()) +
                        " rows are left out by --only " + params.only);
  const auto told = [&](const std::vector<std::string>& lines, const char* what) {
    if (!lines.empty())
      all.notes.push_back(std::to_string(lines.size()) + (lines.size() == 1 ? " row has no " : " rows have no ") +
                          what + ", and is left out where it counts: " + some_of(lines));
  };
  told(no_group, "group");
  told(no_phase, "phase");
  told(no_attempt, "attempt");
  if (!all.has_participants)
    all.notes.push_back("the table has no column " + params.participant +
                        ": every row is an observation of its own, and nothing is compared within participants");
  all.groups = in_order(all.rows, &Observation::group);
  all.phases = in_order(all.rows, &Observation::phase);
  all.has_groups = all.groups.size() > 1;
  all.has_phases = all.phases.size() > 1;
  std::set<int> attempts;
  for (const Observation& o : all.rows)
    if (o.attempt > 0) attempts.insert(o.attempt);
  all.attempts.assign(attempts.begin(), attempts.end());
  all.has_attempts = all.attempts.size() > 1;
  if (all.by_participant(params)) check_groups(all);
  return all;
}

}  // namespace trephine::study::detail
