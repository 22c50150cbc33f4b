// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxel/transfer.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "base/error.h"
#include "base/joined.h"
#include "base/text.h"
#include "voxel/transfer_points.h"

namespace trephine::voxel {
namespace {

using Rgb = std::array<double, 3>;

// Seen of a CT in Hounsfield units: bone from its edge of trabecular tissue on; the skin and what lies beneath it as a
// veil over bone; what contrast medium fills, and bone.
const Named<std::vector<TransferPoint>>& presets() {
  constexpr Rgb red{0.70, 0.16, 0.12}, flesh{0.86, 0.62, 0.50}, ivory{0.93, 0.89, 0.78}, white{0.98, 0.97, 0.93};
  static const Named<std::vector<TransferPoint>> all{
      {"bone", {{150, 0, ivory}, {300, 0.97, ivory}, {1200, 1, white}}},
      {"skin", {{-500, 0, flesh}, {-200, 0.97, flesh}, {200, 0.97, flesh}, {350, 1, ivory}}},
      {"vessels", {{110, 0, red}, {200, 0.5, red}, {350, 0.7, red}, {600, 0.9, ivory}, {1200, 1, white}}}};
  return all;
}

constexpr double same_opacity = 1e-9;

bool is_touched(const TransferFunction& f, int hu) {
  return at_hu(f, hu).opacity >= f.touched_from_opacity - same_opacity;
}

std::string listed_presets() {
  return joined(presets(), ", ", [](const auto& p) { return p.first; });
}

}  // namespace

std::string fault_of_points(const std::vector<TransferPoint>& points) {
  if (points.size() < 2)
    return "points: " + std::to_string(points.size()) + ", must be 2 or more, or give a preset (" + listed_presets() +
           ")";
  for (std::size_t n = 1; n < points.size(); ++n) {
    const std::string at = "points[" + std::to_string(n) + "].hu: " + to_text(points[n].hu);
    if (points[n].hu < points[n - 1].hu)
      return at + ", must be at least " + to_text(points[n - 1].hu) + ": points ascend";
    if (n >= 2 && points[n].hu == points[n - 2].hu) return at + ", three points lie there, at most two may (a step)";
  }
  for (std::size_t n = 1; n < points.size(); ++n)
    if ((points[n].stiffness_n_per_mm > 0) != (points[0].stiffness_n_per_mm > 0))
      return "points[" + std::to_string(n) + "].stiffness_n_per_mm: " + to_text(points[n].stiffness_n_per_mm) +
             ", must be above 0 at all points or be at none";
  const TransferPoint& first = points[points[1].hu == transfer_low_hu && points[0].hu == transfer_low_hu ? 1 : 0];
  if (first.opacity > 0)
    return "points[0].opacity: " + to_text(first.opacity) + ", must be 0: so opaque is what lies below it, air too";
  return "";
}

std::vector<std::string> preset_names() {
  std::vector<std::string> names;
  for (const auto& p : presets()) names.push_back(p.first);
  return names;
}

const std::vector<TransferPoint>& preset_points(std::string_view name) {
  const auto* found = find_item(presets(), std::string(name));
  if (!found) throw Error(ExitCode::internal, "", "preset", std::string(name) + ", no such preset");
  return *found;
}

TransferFunction resolved(TransferFunction f) {
  if (!f.preset.empty()) f.points = preset_points(f.preset);
  f.preset.clear();
  return f;
}

TransferFunction window_function(int low_hu, int high_hu, Rgb colour) {
  TransferFunction f;
  f.points = {{double(low_hu) - 1, 0, colour}, {double(low_hu), 1, colour}};
  if (high_hu < transfer_high_hu) {
    f.points.push_back({double(high_hu), 1, colour});
    f.points.push_back({double(high_hu) + 1, 0, colour});
  }
  return f;
}

TransferPoint at_hu(const TransferFunction& f, double hu) {
  const auto above = std::upper_bound(f.points.begin(), f.points.end(), hu,
                                      [](double value, const TransferPoint& p) { return value < p.hu; });
  if (above == f.points.begin()) return f.points.front();
  const TransferPoint& a = *(above - 1);
  if (above == f.points.end()) return a;
  const double t = (hu - a.hu) / (above->hu - a.hu);
  TransferPoint p{hu, a.opacity + t * (above->opacity - a.opacity), a.colour_rgb,
                  a.stiffness_n_per_mm + t * (above->stiffness_n_per_mm - a.stiffness_n_per_mm)};
  for (std::size_t c = 0; c < 3; ++c) p.colour_rgb[c] += t * (above->colour_rgb[c] - a.colour_rgb[c]);
  return p;
}

std::optional<std::array<int, 2>> touched_hu(const TransferFunction& f) {
  std::optional<std::array<int, 2>> range;
  if (f.points.empty()) return range;
  for (int hu = transfer_low_hu; hu <= transfer_high_hu; ++hu) {
    if (!is_touched(f, hu)) continue;
    if (range && (*range)[1] != hu - 1) return std::nullopt;
    range = {range ? (*range)[0] : hu, hu};
  }
  if (range && (*range)[1] == transfer_high_hu) (*range)[1] = std::numeric_limits<std::int16_t>::max();
  return range;
}

double stiffest_n_per_mm(const TransferFunction& function) {
  const TransferFunction f = resolved(function);
  double most = 0;
  if (const auto touched = touched_hu(f))
    for (int hu = (*touched)[0]; hu <= std::min((*touched)[1], transfer_high_hu); ++hu)
      most = std::max(most, at_hu(f, hu).stiffness_n_per_mm);
  return most;
}

std::string TransferFunction::fault() const {
  if (!preset.empty() && !points.empty()) return "points: are there beside a preset: give one of the two";
  if (preset.empty())
    if (const std::string what = fault_of_points(points); !what.empty()) return what;
  const TransferFunction f = resolved(*this);
  if (touched_hu(f)) return "";
  double most = 0;
  for (const TransferPoint& p : f.points) most = std::max(most, p.opacity);
  return "touched_from_opacity: " + to_text(touched_from_opacity) +
         (most < touched_from_opacity - same_opacity
              ? ", must be at most " + to_text(most) + ", the largest opacity: nothing would be touched"
              : ", several ranges of HU are so opaque, must be one: give each a shape of its own");
}

TransferFunction transfer_from_text(const std::string& text, const std::string& flag) {
  const auto refuse = [&](const std::string& item, const std::string& what) {
    throw Error(ExitCode::usage, "", flag, item + ": " + what);
  };
  TransferFunction f;
  if (find_item(presets(), text)) {
    f.preset = text;
    return resolved(f);
  }
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(',', at), text.size());
    const std::string item = text.substr(at, end - at);
    at = end + 1;
    const std::size_t first = item.find(':'), second = item.find(':', first + 1);
    if (first == std::string::npos || second == std::string::npos || item.size() - second != 7)
      refuse(item, "must be a preset (" + listed_presets() + "), or points HU:OPACITY:RRGGBB with commas between them");
    char *hu_end = nullptr, *opacity_end = nullptr, *colour_end = nullptr;
    TransferPoint p;
    p.hu = std::strtod(item.c_str(), &hu_end);
    p.opacity = std::strtod(item.c_str() + first + 1, &opacity_end);
    const unsigned long rgb = std::strtoul(item.c_str() + second + 1, &colour_end, 16);
    if (hu_end != item.c_str() + first || !(p.hu >= transfer_low_hu && p.hu <= transfer_high_hu))
      refuse(item, "its HU must be a number from -1024 to 3071");
    if (opacity_end != item.c_str() + second || !(p.opacity >= 0 && p.opacity <= 1))
      refuse(item, "its opacity must be a number from 0 to 1");
    if (*colour_end != 0 || item[second + 1] == '-' || item[second + 1] == '+')
      refuse(item, "its colour must be six hexadecimal digits");
    for (std::size_t c = 0; c < 3; ++c) p.colour_rgb[c] = double(rgb >> (16 - 8 * c) & 255) / 255;
    f.points.push_back(p);
  }
  if (const std::string what = fault_of_points(f.points); !what.empty()) refuse(text, what);
  return f;
}

}  // namespace trephine::voxel
