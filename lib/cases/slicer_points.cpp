// SPDX-License-Identifier: GPL-3.0-or-later
// Points from 3D Slicer: markups JSON (Slicer's markups-schema-v1.0.x) and the comma-separated table before it.
#include "cases/slicer_points.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "base/text.h"
#include "json/json_at.h"

namespace trephine::cases {
namespace {

using json::Json;
using json::JsonAt;

constexpr double farthest_mm = 1e5;
constexpr std::size_t longest_name = 64, most_points = 10000;

[[noreturn]] void refuse(const std::string& field, const std::string& what) {
  throw Error(ExitCode::bad_input, "", field, what);
}

/// "Tragus left" -> tragus_left. What a label may hold is bounded: it goes into the case.
std::string name_of(const std::string& label, const std::string& field) {
  std::string name;
  for (const char c : label) {
    const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'), digit = c >= '0' && c <= '9';
    if (!letter && !digit && c != ' ' && c != '-' && c != '_')
      refuse(field, "a label may hold letters, digits, blanks, hyphens and underscores");
    name += letter ? char(c | 0x20) : digit ? c : '_';
  }
  if (name.empty()) refuse(field, "is empty: the label says which landmark it is");
  if (name.size() > longest_name) refuse(field, "is longer than 64 characters");
  return name;
}

class Points {
 public:
  void add(const std::string& name, Vec3 p, bool ras, const std::string& field) {
    for (int a = 0; a < 3; ++a)
      if (!(std::abs(p[a]) <= farthest_mm)) refuse(field, "must be finite and within 100000 mm");
    if (ras) p = {-p.x, -p.y, p.z};
    // Not -0: what is written of it must not depend on the file's system.
    for (int a = 0; a < 3; ++a) p[a] += 0.0;
    for (const CaseLandmark& l : points_)
      if (l.name == name) {
        if (l.position_mm != p) refuse(field, name + " is there twice, at different places");
        return;
      }
    if (points_.size() == most_points) refuse(field, "more than 10000 points");
    points_.push_back({name, p, 1, "given"});
  }
  std::vector<CaseLandmark> take(const std::string& field) {
    if (points_.empty()) refuse(field, "holds no point that was placed");
    return std::move(points_);
  }

 private:
  std::vector<CaseLandmark> points_;
};

bool is_ras(const JsonAt& at) {
  const std::string system = at.text();
  if (system == "LPS") return false;
  if (system == "RAS") return true;
  at.refuse("must be LPS or RAS");
}

void check_units(const JsonAt& at) {
  const auto check = [](const JsonAt& unit) {
    if (unit.text() != "mm") unit.refuse("must be mm");
  };
  if (!at.value().is_array()) return check(at);
  for (const JsonAt& unit : at.items()) check(unit);
}

/// A row's fields; a field in double quotes may hold commas and, doubled, quotes.
std::vector<std::string> fields_of(const std::string& row, const std::string& where) {
  std::vector<std::string> out(1);
  bool quoted = false;
  for (std::size_t i = 0; i < row.size(); ++i) {
    const char c = row[i];
    if (c == '"') {
      if (quoted && i + 1 < row.size() && row[i + 1] == '"')
        out.back() += row[i++];
      else
        quoted = !quoted;
    } else if (c == ',' && !quoted) {
      if (out.size() == 64) refuse(where, "has more than 64 fields");
      out.emplace_back();
    } else {
      out.back() += c;
    }
  }
  if (quoted) refuse(where, "a quotation mark is not closed");
  for (std::string& field : out) field = trimmed(field);
  return out;
}

/// "# key = value" -> value, where the key is that one.
std::optional<std::string> header_value(const std::string& line, const std::string& key) {
  const std::size_t equals = line.find('=');
  if (equals == std::string::npos || trimmed(line.substr(1, equals - 1)) != key) return {};
  return trimmed(line.substr(equals + 1));
}

}  // namespace

std::vector<CaseLandmark> parse_slicer_markups(std::string_view text) {
  const Json parsed = json::parse_json(text);
  const JsonAt root(parsed, "");
  Points points;
  for (const JsonAt& markup : root["markups"].items()) {
    const auto controls = markup.optional("controlPoints");
    if (!controls) continue;
    const bool ras = is_ras(markup["coordinateSystem"]);
    if (const auto units = markup.optional("coordinateUnits")) check_units(*units);
    for (const JsonAt& control : controls->items()) {
      if (const auto status = control.optional("positionStatus")) {
        const std::string s = status->text();
        if (s == "undefined" || s == "preview" || s == "missing") continue;
        if (s != "defined") status->refuse("must be defined, undefined, preview or missing");
      }
      const JsonAt label = control["label"], position = control["position"];
      const std::vector<double> p = position.numbers(3);
      points.add(name_of(label.text(), label.path()), {p[0], p[1], p[2]}, ras, position.path());
    }
  }
  return points.take("markups");
}

std::vector<CaseLandmark> parse_slicer_fcsv(std::string_view text) {
  Points points;
  std::optional<bool> ras;
  std::vector<std::string> columns{"id", "x", "y", "z", "ow", "ox", "oy", "oz", "vis", "sel", "lock", "label"};
  constexpr std::size_t status_column = 14;  // not named in the columns' line; 2: placed
  std::size_t number = 0;
  for (std::size_t from = 0; from < text.size();) {
    const std::size_t end = std::min(text.find('\n', from), text.size());
    const std::string line = trimmed(std::string(text.substr(from, end - from))),
                      where = "line " + to_text(double(++number));
    from = end + 1;
    if (line.empty()) continue;
    if (line[0] == '#') {
      if (const auto system = header_value(line, "CoordinateSystem")) {
        if (*system == "RAS" || *system == "0")
          ras = true;
        else if (*system == "LPS" || *system == "1")
          ras = false;
        else
          refuse("CoordinateSystem", "must be LPS, RAS, 0 (RAS) or 1 (LPS)");
      } else if (const auto names = header_value(line, "columns")) {
        columns = fields_of(*names, where);
      }
      continue;
    }
    if (!ras) refuse("CoordinateSystem", "is missing before the first point");
    const std::vector<std::string> fields = fields_of(line, where);
    const auto field = [&](const char* name) {
      const auto at = std::find(columns.begin(), columns.end(), name);
      if (at == columns.end()) refuse("columns", std::string("no column ") + name);
      const std::size_t i = std::size_t(at - columns.begin());
      if (i >= fields.size()) refuse(where, std::string("has no ") + name);
      return fields[i];
    };
    if (fields.size() > status_column && !fields[status_column].empty() && fields[status_column] != "2") continue;
    Vec3 p;
    const char* const axes[] = {"x", "y", "z"};
    for (int a = 0; a < 3; ++a) {
      const auto value = parse_number(field(axes[a]));
      if (!value) refuse(where, std::string(axes[a]) + " is not a number");
      p[a] = *value;
    }
    points.add(name_of(field("label"), where), p, *ras, where);
  }
  return points.take("fcsv");
}

}  // namespace trephine::cases
