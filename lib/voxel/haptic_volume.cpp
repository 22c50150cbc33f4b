// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxel/haptic_volume.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "base/error.h"
#include "base/parallel.h"
#include "voxel/raw_voxel.h"

namespace trephine::voxel {
namespace {

[[noreturn]] void refuse(const std::string& field, const std::string& what) {
  throw Error(ExitCode::bad_input, "", field, what);
}

void check_lattice(const grid::Lattice& l, std::size_t voxels) {
  std::size_t count = 1;
  for (const int n : l.size) {
    if (n < 1) refuse("sizes", std::to_string(n) + ", must be at least 1");
    if (count > std::numeric_limits<std::size_t>::max() / std::size_t(n)) refuse("sizes", "too large");
    count *= std::size_t(n);
  }
  if (count != voxels) refuse("sizes", "do not agree with the voxels");
  for (int a = 0; a < 3; ++a)
    if (!(l.spacing_mm[a] > 0) || !std::isfinite(l.spacing_mm[a])) refuse("spacing", "must be positive and finite");
  if (!is_finite(l.origin_mm)) refuse("origin", "must be finite");
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b <= a; ++b)
      if (!(std::abs(dot(l.direction.column[std::size_t(a)], l.direction.column[std::size_t(b)]) - (a == b)) <= 1e-6))
        refuse("direction", "must be orthonormal");
}

void check_name(const std::string& name, const std::string& field) {
  const auto allowed = [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_'; };
  if (name.empty() || name.size() > 64 || !std::all_of(name.begin(), name.end(), allowed))
    refuse(field, "a name is 1 to 64 of a-z, 0-9 and _");
}

void check_shapes(const HapticVolume& volume) {
  const auto& shapes = volume.shapes;
  if (shapes.size() > std::size_t(haptic_max_shapes))
    refuse("shapes", "more than " + std::to_string(haptic_max_shapes));
  for (std::size_t n = 0; n < shapes.size(); ++n) {
    const HapticShape& s = shapes[n];
    const std::string field = "shapes[" + std::to_string(n) + "].";
    check_name(s.name, field + "name");
    if (s.number < 1 || s.number > haptic_max_shapes)
      refuse(field + "number", std::to_string(s.number) + ", must be 1 to " + std::to_string(haptic_max_shapes));
    if (n > 0 && s.number <= shapes[n - 1].number) refuse(field + "number", "must ascend");
    if (s.window_low > s.window_high) refuse(field + "window", "its low end lies above its high end");
    for (std::size_t m = 0; m < n; ++m) {
      if (s.name == shapes[m].name) refuse(field + "name", "'" + s.name + "' twice");
      if (s.window_low <= shapes[m].window_high && shapes[m].window_low <= s.window_high)
        refuse(field + "window", "overlaps that of '" + shapes[m].name + "'");
    }
    if (volume.encoding == HapticEncoding::hu && s.window_low <= haptic_beyond_hu)
      refuse(field + "window", "of '" + s.name + "' begins at " + std::to_string(s.window_low) + " HU, must be above " +
                                   std::to_string(haptic_beyond_hu) + ": that is what lies beyond the volume");
    if (volume.encoding != HapticEncoding::occupancy) continue;
    const HapticShape own = occupancy_shape(s.name, s.number);
    if (s.window_low != own.window_low || s.window_high != own.window_high)
      refuse(field + "window", "is not that of shape " + std::to_string(s.number) + ": " +
                                   std::to_string(own.window_low) + " to " + std::to_string(own.window_high));
  }
}

void check_voxels(const HapticVolume& volume) {
  std::vector<std::uint8_t> foreign(65536, 1);
  foreign[std::size_t(haptic_empty)] = 0;
  for (const HapticShape& s : volume.shapes)
    for (int v = s.window_low; v <= s.window_high; ++v)
      if (detail::split(std::int16_t(v)).number == s.number) foreign[std::size_t(v)] = 0;
  constexpr std::int64_t piece = 1 << 18;
  const auto& voxels = volume.voxels.voxels;
  const std::int64_t count = std::int64_t(voxels.size());
  std::vector<std::uint8_t> wrong(std::size_t((count + piece - 1) / piece), 0);
  parallel_for(0, count, piece, [&](std::int64_t from, std::int64_t to) {
    std::uint8_t any = 0;
    for (std::int64_t i = from; i < to; ++i) any |= foreign[static_cast<std::uint16_t>(voxels[std::size_t(i)])];
    wrong[std::size_t(from / piece)] = any;
  });
  const auto found = std::find(wrong.begin(), wrong.end(), 1);
  if (found == wrong.end()) return;
  for (std::size_t i = std::size_t(found - wrong.begin()) * piece;; ++i)
    if (foreign[static_cast<std::uint16_t>(voxels[i])])
      refuse("data", "voxel " + std::to_string(i) + ": " + std::to_string(voxels[i]) + " is a value of no shape");
}

}  // namespace

const HapticShape* HapticVolume::find_shape(const std::string& name) const {
  for (const HapticShape& s : shapes)
    if (s.name == name) return &s;
  return nullptr;
}

HapticVolume copy_without_hardness(const HapticVolume& volume) {
  HapticVolume out;
  out.encoding = volume.encoding;
  out.voxels = volume.voxels;
  out.shapes = volume.shapes;
  return out;
}

HapticShape occupancy_shape(const std::string& name, int number) {
  const int base = haptic_base_step * number;
  return {name, number, std::int16_t(base + 1), std::int16_t(base + haptic_bare_offset + haptic_full)};
}

std::array<int, haptic_max_shapes + 1> adjoining_windows(const std::vector<HapticShape>& shapes) {
  std::vector<HapticShape> sorted = shapes;
  std::sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.window_low < b.window_low; });
  std::array<int, haptic_max_shapes + 1> group{};
  int now = 0, end = 0;
  for (const HapticShape& s : sorted) {
    if (now == 0 || s.window_low != end + 1) ++now;
    if (s.number >= 1 && s.number <= haptic_max_shapes) group[std::size_t(s.number)] = now;
    end = s.window_high;
  }
  return group;
}

void check_haptic_volume(const HapticVolume& volume) {
  check_lattice(volume.voxels, volume.voxels.voxels.size());
  check_shapes(volume);
  if (!volume.hardness.voxels.empty() || volume.hardness.count() > 0) {
    const grid::Lattice &hard = volume.hardness, &soft = volume.voxels;
    if (hard != soft || volume.hardness.voxels.size() != volume.voxels.voxels.size())
      throw Error(ExitCode::bad_input, "", "hardness", "does not lie on the lattice of the volume")
          .finds_fault_with({hardness_part});
  }
  if (volume.encoding == HapticEncoding::occupancy) check_voxels(volume);
}

}  // namespace trephine::voxel
