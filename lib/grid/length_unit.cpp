// SPDX-License-Identifier: GPL-3.0-or-later
#include "grid/length_unit.h"

#include <algorithm>
#include <cctype>
#include <map>

namespace trephine::grid {

std::optional<double> mm_per_unit(const std::string& name) {
  static const std::map<std::string, double> known = {
      {"nm", 1e-6},      {"nanometer", 1e-6},  {"nanometre", 1e-6},  {"um", 1e-3},        {"micron", 1e-3},
      {"microns", 1e-3}, {"micrometer", 1e-3}, {"micrometre", 1e-3}, {"\xc2\xb5m", 1e-3}, {"\xce\xbcm", 1e-3},
      {"mm", 1},         {"millimeter", 1},    {"millimetre", 1},    {"millimeters", 1},  {"millimetres", 1},
      {"cm", 10},        {"centimeter", 10},   {"centimetre", 10},   {"centimeters", 10}, {"centimetres", 10},
      {"dm", 100},       {"m", 1000},          {"meter", 1000},      {"metre", 1000},     {"meters", 1000},
      {"metres", 1000},  {"km", 1e6},          {"in", 25.4},         {"inch", 25.4},      {"inches", 25.4},
      {"ft", 304.8},     {"foot", 304.8},      {"feet", 304.8}};
  std::string lower = name;
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const auto found = known.find(lower);
  return found == known.end() ? std::nullopt : std::optional<double>(found->second);
}

}  // namespace trephine::grid
