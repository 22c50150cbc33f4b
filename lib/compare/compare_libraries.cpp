// SPDX-License-Identifier: GPL-3.0-or-later
#include "compare/compare_libraries.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/text.h"
#include "base/text_table.h"

namespace trephine::compare {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

std::vector<std::string> tokens_of(const fs::path& library) {
  std::vector<std::string> tokens;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(library, error))
    if (fs::exists(entry.path() / "case.json", error)) tokens.push_back(entry.path().filename().string());
  std::sort(tokens.begin(), tokens.end());
  return tokens;
}

LibraryCaseChange compare_one(const fs::path& old_case, const fs::path& new_case, const std::string& token,
                              const CompareParams& params, const Progress& progress) {
  LibraryCaseChange change;
  change.token = token;
  try {
    change.comparison = compare_cases(cases::load_case(old_case), cases::load_case(new_case), params, progress);
  } catch (const Error& e) {
    // Where the library lies is nobody's business.
    std::filesystem::path file = std::filesystem::path(e.file()).filename();
    for (const std::filesystem::path& root : {old_case, new_case})
      if (const auto within = std::filesystem::path(e.file()).lexically_relative(root);
          !within.empty() && *within.begin() != "..")
        file = within;
    for (const std::string& part : {file.string(), e.field(), std::string(e.what())})
      if (!part.empty()) change.fault += (change.fault.empty() ? "" : ": ") + printable(part);
  }
  return change;
}

/// The largest of something and whose it is, as cells of a table.
struct Most {
  std::string name;
  double value = -1;
  void see(const std::string& whose, double v) {
    if (v > value) name = whose, value = v;
  }
  void add_to(std::vector<std::string>& row, int digits) const {
    row.push_back(value < 0 ? "-" : fmt::format("{:.{}f}", value, digits));
    row.push_back(value > 0 ? name : "");
  }
};

std::vector<std::string> row_of(const LibraryCaseChange& c) {
  std::vector<std::string> row{c.token};
  if (c.in != InCases::both || !c.fault.empty() || c.comparison.identical) {
    row.insert(row.end(), 6, "");
    row.push_back("");
    row.push_back(c.in == InCases::only_old   ? "only in the old library"
                  : c.in == InCases::only_new ? "only in the new library"
                  : !c.fault.empty()          ? c.fault
                                              : "the same");
    return row;
  }
  Most deviation, volume, moved;
  std::string note;
  for (const AnatomyChange& a : c.comparison.anatomies) {
    if (a.same_bytes) deviation.see(a.name, 0), volume.see(a.name, 0);
    if (a.deviation) deviation.see(a.name, a.deviation->both.max_mm);
    if (const auto change_ml = a.change_ml(); change_ml && *a.old_ml > 0)
      volume.see(a.name, 100 * std::abs(*change_ml) / *a.old_ml);
    if (a.in != InCases::both) note += (note.empty() ? "" : "; ") + a.name + " " + a.not_measured;
  }
  for (const PointChange& p : c.comparison.points) {
    if (p.moved_mm) moved.see(p.name, *p.moved_mm);
    if (p.in != InCases::both)
      note += (note.empty() ? "" : "; ") + p.name + " is not in the " + (p.in == InCases::only_old ? "new" : "old") +
              " case";
  }
  deviation.add_to(row, 3);
  volume.add_to(row, 3);
  moved.add_to(row, 3);
  std::string changed_class;
  for (const ValueChange& v : c.comparison.figures)
    if (v.name == "class")
      changed_class = (v.old_value ? trephine::to_text(*v.old_value) : "-") + " -> " +
                      (v.new_value ? trephine::to_text(*v.new_value) : "-");
  row.push_back(changed_class);
  row.push_back(note);
  return row;
}

}  // namespace

bool is_library(const fs::path& folder) {
  std::error_code error;
  return !fs::exists(folder / "case.json", error) && !tokens_of(folder).empty();
}

std::vector<LibraryCaseChange> compare_libraries(const fs::path& old_library, const fs::path& new_library,
                                                 const CompareParams& params, const Progress& progress) {
  std::map<std::string, int> tokens;  // 1: in the old one, 2: in the new one
  for (const std::string& t : tokens_of(old_library)) tokens[t] |= 1;
  for (const std::string& t : tokens_of(new_library)) tokens[t] |= 2;
  std::vector<LibraryCaseChange> all;
  for (const auto& [token, in] : tokens) {
    const double n = double(tokens.size()), done = double(all.size());
    const Progress part = progress.part(done / n, (done + 1) / n);
    progress.check();
    if (in == 3) {
      all.push_back(compare_one(old_library / token, new_library / token, token, params, part));
      continue;
    }
    all.emplace_back();
    all.back().token = token;
    all.back().in = in == 1 ? InCases::only_old : InCases::only_new;
  }
  return all;
}

std::vector<std::string> beyond_limits(const std::vector<LibraryCaseChange>& cases, const CompareParams& params) {
  std::vector<std::string> beyond;
  const bool limited = params.max_deviation_mm > 0 || params.max_point_mm > 0 || params.max_volume_ratio > 0;
  for (const LibraryCaseChange& c : cases) {
    if (limited && c.in != InCases::both)
      beyond.push_back(c.token + ": is not in the " + (c.in == InCases::only_old ? "new" : "old") + " library");
    if (!c.fault.empty()) beyond.push_back(c.token + ": " + c.fault);
    for (const std::string& line : beyond_limits(c.comparison, params)) beyond.push_back(c.token + ": " + line);
  }
  return beyond;
}

std::string libraries_text(const std::vector<LibraryCaseChange>& cases) {
  std::vector<std::vector<std::string>> rows{
      {"case", "max mm", "of", "volume %", "of", "moved mm", "point", "class", "note"}};
  for (const LibraryCaseChange& c : cases) rows.push_back(row_of(c));
  return text_table(rows, "lrlrlrlll");
}

std::string libraries_json(const std::vector<LibraryCaseChange>& cases) {
  Json list = Json::array();
  for (const LibraryCaseChange& c : cases) {
    Json one{{"case", c.token}, {"in", to_text(c.in)}};
    if (!c.fault.empty())
      one["fault"] = c.fault;
    else if (c.in == InCases::both)
      one["comparison"] = Json::parse(comparison_json(c.comparison));
    list.push_back(std::move(one));
  }
  return Json{{"cases", std::move(list)}}.dump(2) + "\n";
}

}  // namespace trephine::compare
