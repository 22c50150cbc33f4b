// SPDX-License-Identifier: GPL-3.0-or-later
#include "grid/nrrd_scale.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>

#include "base/error.h"
#include "base/text.h"
#include "grid/length_unit.h"
#include "grid/nrrd_header.h"

namespace trephine::grid::detail {

[[noreturn]] void refuse(const std::string& field, const std::string& what) {
  throw Error(ExitCode::bad_input, "", field, what);
}

std::string lower(std::string s) {
  for (char& c : s)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return s;
}

std::vector<std::string> words(const std::string& s) {
  std::vector<std::string> out;
  std::string word;
  for (const char c : s + " ") {
    if (c != ' ' && c != '\t') {
      word.push_back(c);
    } else if (!word.empty()) {
      out.push_back(std::move(word));
      word.clear();
    }
  }
  return out;
}

bool is_known_field(const std::string& name) {
  static const std::set<std::string> known = {
      "type",        "dimension",  "space",    "spacedimension", "sizes",      "spacedirections",
      "spaceorigin", "spaceunits", "kinds",    "endian",         "encoding",   "spacings",
      "thicknesses", "axismins",   "axismaxs", "centers",        "centerings", "labels",
      "units",       "content",    "number",   "blocksize",      "min",        "max",
      "oldmin",      "oldmax",     "datafile", "lineskip",       "byteskip",   "measurementframe",
      "sampleunits"};
  std::string plain;
  for (const char c : lower(name))
    if (c != ' ') plain += c;
  return known.count(plain) > 0;
}

std::string tellable_key(const std::string& key) {
  const bool plain = !key.empty() && key.size() <= 40 && std::all_of(key.begin(), key.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || c == ' ';
  });
  return plain ? key : "?";
}

std::string told_unknown(const std::vector<std::string>& keys) {
  constexpr std::size_t max_told = 20;
  std::string all;
  for (std::size_t i = 0; i < std::min(keys.size(), max_told); ++i) all += (i ? ", " : "") + keys[i];
  if (keys.size() > max_told) all += " and " + std::to_string(keys.size() - max_told) + " more";
  return all.empty() ? all : "keys that are not known are ignored: " + all;
}

// Other programs write 1e-05 and +1; what must hold is that the whole word is one finite number.
double number_of(const std::string& word, const std::string& field) {
  double v = 0;
  const char* begin = word.data() + (word.size() > 1 && word[0] == '+' ? 1 : 0);
  const char* end = word.data() + word.size();
  const auto r = std::from_chars(begin, end, v);
  if (r.ec != std::errc() || r.ptr != end || !std::isfinite(v)) refuse(field, "'" + word + "' is not a finite number");
  return v;
}

// mm of a unit along each axis of space: `"mm" "mm" "mm"`; 1 where there is no such field.
Vec3 units_of(const Fields& fields) {
  Vec3 mm{1, 1, 1};
  const auto found = fields.find("space units");
  if (found == fields.end()) return mm;
  std::string plain = found->second;
  if (std::count(plain.begin(), plain.end(), '"') % 2 != 0)
    refuse("space units", "its quotation marks are not in pairs");
  std::replace(plain.begin(), plain.end(), '"', ' ');
  const auto names = words(plain);
  if (names.size() != 3) refuse("space units", "must be 3 units in quotation marks");
  for (int a = 0; a < 3; ++a) {
    const auto unit = mm_per_unit(names[a]);
    if (!unit) refuse("space units", "'" + names[a] + "' is no unit of length that is known");
    mm[a] = *unit;
  }
  return mm;
}

// Fields that would give the axes or the samples another scale than those that are read, or contradict them.
void check_scales(const Fields& fields, const std::array<Vec3, 3>& steps, std::size_t list_axes) {
  const auto per_axis = [&](const char* name) {
    const auto found = fields.find(name);
    std::vector<std::string> parts = found == fields.end() ? std::vector<std::string>() : words(found->second);
    if (found != fields.end() && parts.size() != 3 + list_axes) refuse(name, "must be one for each axis");
    if (!parts.empty()) parts.erase(parts.begin(), parts.begin() + static_cast<std::ptrdiff_t>(list_axes));
    return parts;
  };
  const auto is_none = [](const std::string& word) { return lower(word) == "nan" || lower(word) == "none"; };
  const auto spacings = per_axis("spacings");
  for (std::size_t a = 0; a < spacings.size(); ++a)
    if (const double length = norm(steps[a]);
        !is_none(spacings[a]) && !(std::abs(number_of(spacings[a], "spacings") - length) <= 1e-4 * length))
      refuse("spacings",
             "axis " + std::to_string(a) + ": " + spacings[a] + ", but the space directions say " + to_text(length));
  for (const char* name : {"axis mins", "axismins", "axis maxs", "axismaxs"})
    for (const std::string& word : per_axis(name))
      if (!is_none(word)) refuse(name, "contradicts space directions and origin: remove it");
  const auto units = fields.find("units");
  if (units != fields.end()) {
    std::string plain = units->second;
    std::replace(plain.begin(), plain.end(), '"', ' ');
    for (const std::string& unit : words(plain))
      if (mm_per_unit(unit).value_or(1) != 1) refuse("units", "'" + unit + "': give space units instead");
  }
  for (const std::string& kind : per_axis("kinds"))
    if (const std::string k = lower(kind); k != "domain" && k != "space" && !is_none(kind) && k != "???")
      refuse("kinds", "'" + kind + "', must be domain: each voxel holds one number");
  for (const char* name : {"old min", "oldmin", "old max", "oldmax"})
    if (const auto found = fields.find(name); found != fields.end() && !is_none(found->second))
      refuse(name, "the samples stand for others, which are not computed: convert the file");
}

}  // namespace trephine::grid::detail
