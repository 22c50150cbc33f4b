// SPDX-License-Identifier: GPL-3.0-or-later
#include "cast/transfer_edit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <mutex>

#include "base/error.h"
#include "base/joined.h"
#include "base/parallel.h"
#include "base/text.h"
#include "base/write_file.h"
#include "json/declared_json.h"
#include "voxel/transfer_points.h"

namespace trephine::cast {
namespace {

using Points = std::vector<voxel::TransferPoint>;
constexpr std::uint64_t max_bytes = 1 << 20;
constexpr const char* file_ending = ".yaml";

// Two points at the lowest HU are a step there, and what lies below the first of them, air too, is what the second
// says.
void clear_the_first(Points& points) {
  points.front().opacity = 0;
  if (points[1].hu <= voxel::transfer_low_hu) points[1].opacity = 0;
}

bool are_a_step(const Points& points, std::size_t n) { return points[n].hu == points[n + 1].hu; }

}  // namespace

voxel::TransferFunction with_moved(voxel::TransferFunction f, std::size_t n, double hu, double opacity) {
  Points& p = f.points;
  double low = voxel::transfer_low_hu, high = voxel::transfer_high_hu;
  if (n > 0) low = p[n - 1].hu + (n > 1 && are_a_step(p, n - 2) ? 1 : 0);
  if (n + 1 < p.size()) high = p[n + 1].hu - (n + 2 < p.size() && are_a_step(p, n + 1) ? 1 : 0);
  if (low <= high) p[n].hu = std::clamp(std::round(hu), low, high);
  p[n].opacity = std::clamp(opacity, 0.0, 1.0);
  clear_the_first(p);
  return f;
}

voxel::TransferFunction with_colour(voxel::TransferFunction f, std::size_t n, std::array<double, 3> colour_rgb) {
  for (std::size_t c = 0; c < 3; ++c) f.points[n].colour_rgb[c] = std::clamp(colour_rgb[c], 0.0, 1.0);
  return f;
}

std::optional<AddedPoint> with_added(voxel::TransferFunction f, double hu, double opacity) {
  const double at_hu = std::clamp(std::round(hu), double(voxel::transfer_low_hu), double(voxel::transfer_high_hu));
  voxel::TransferPoint point = voxel::at_hu(f, at_hu);
  point.hu = at_hu;
  point.opacity = std::clamp(opacity, 0.0, 1.0);
  const auto same = [&](const voxel::TransferPoint& p) { return p.hu == point.hu; };
  if (f.points.size() >= voxel::max_transfer_points || std::count_if(f.points.begin(), f.points.end(), same) > 1)
    return std::nullopt;
  const auto behind = std::upper_bound(f.points.begin(), f.points.end(), point.hu,
                                       [](double value, const voxel::TransferPoint& p) { return value < p.hu; });
  const std::size_t at = std::size_t(behind - f.points.begin());
  f.points.insert(behind, point);
  clear_the_first(f.points);
  return AddedPoint{std::move(f), at};
}

voxel::TransferFunction with_removed(voxel::TransferFunction f, std::size_t n) {
  if (f.points.size() <= 2) return f;
  f.points.erase(f.points.begin() + std::ptrdiff_t(n));
  clear_the_first(f.points);
  return f;
}

std::string colour_text(const std::array<double, 3>& colour_rgb) {
  std::string text;
  for (const double c : colour_rgb) text += fmt::format("{:02x}", int(std::lround(255 * c)));
  return text;
}

std::string points_text(const voxel::TransferFunction& f) {
  return joined(f.points, ",", [](const voxel::TransferPoint& p) {
    return to_text(p.hu) + ":" + to_text(p.opacity) + ":" + colour_text(p.colour_rgb);
  });
}

std::string transfer_file_text(const voxel::TransferFunction& f) {
  std::string text = "{\n  \"points\": [";
  for (std::size_t n = 0; n < f.points.size(); ++n) {
    voxel::TransferPoint point = f.points[n];
    text += (n ? ",\n    " : "\n    ") + json::declared_json(parameters_of<voxel::TransferPoint>(), &point, -1);
  }
  return text + "\n  ],\n  \"touched_from_opacity\": " + to_text(f.touched_from_opacity) + "\n}\n";
}

voxel::TransferFunction read_transfer_file(const std::filesystem::path& file) {
  return with_file(file.string(), [&] {
    const std::vector<char> bytes = read_file(file, max_bytes);
    voxel::TransferFunction f;
    ParameterSet set = parameters_of<voxel::TransferFunction>();
    set.fault = nullptr;
    json::read_declared_json({bytes.data(), bytes.size()}, set, &f);
    if (!f.preset.empty() && f.points.empty()) return voxel::resolved(f);
    if (!f.preset.empty())
      throw Error(ExitCode::bad_input, "", "points", "are there beside a preset: give one of the two");
    if (const std::string what = voxel::fault_of_points(f.points); !what.empty())
      throw Error(ExitCode::bad_input, "", "", what);
    return f;
  });
}

voxel::TransferFunction transfer_of(const std::string& text, const std::string& flag) {
  const std::filesystem::path file(text);
  return file.extension() == file_ending ? read_transfer_file(file) : voxel::transfer_from_text(text, flag);
}

HuHistogram::HuHistogram(const grid::Grid<std::int16_t>& voxels) {
  std::mutex mutex;
  parallel_for(0, voxels.size[2], 1, [&](std::int64_t begin, std::int64_t end) {
    std::vector<std::uint64_t> own(bins, 0);
    for (std::size_t n = voxels.index(0, 0, int(begin)), last = voxels.index(0, 0, int(end)); n < last; ++n) {
      const int hu = __atomic_load_n(&voxels.voxels[n], __ATOMIC_RELAXED);  // a servo loop may be cutting
      ++own[std::size_t(std::clamp((hu - voxel::transfer_low_hu) / bin_hu, 0, bins - 1))];
    }
    const std::lock_guard<std::mutex> lock(mutex);
    for (std::size_t b = 0; b < own.size(); ++b) counts[b] += own[b];
  });
  most_ = *std::max_element(counts.begin(), counts.end());
}

double HuHistogram::height(int bin) const {
  return most_ > 0 ? std::log1p(double(counts[std::size_t(bin)])) / std::log1p(double(most_)) : 0;
}

}  // namespace trephine::cast
