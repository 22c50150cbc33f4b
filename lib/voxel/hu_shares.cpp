// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxel/hu_shares.h"

#include <algorithm>

#include "voxel/raw_voxel.h"

namespace trephine::voxel {
namespace {

// All that a scanner gives lies within so many HU of a window's end, so that values are as straight as the HU are.
constexpr double reach_hu = 4096;
double share_of(double hu_inside) { return std::clamp(0.5 + hu_inside / (2 * reach_hu), 0.0, 1.0); }

}  // namespace

HuShares::HuShares(const HapticVolume& volume, int number) : volume_(volume), group_(adjoining_windows(volume.shapes)) {
  for (const HapticShape& s : volume.shapes)
    if (s.number == number) own_ = s;
}

// Where the shape ends towards a voxel above it.
double HuShares::top_towards(int hu) const {
  for (const HapticShape& s : volume_.shapes)
    if (hu >= s.window_low && hu <= s.window_high && group_[std::size_t(s.number)] == group_[std::size_t(own_.number)])
      return s.window_low;
  return own_.window_high + 0.5;
}

std::optional<double> HuShares::of_value(int hu) const {
  if (hu > own_.window_high) return share_of(std::min(top_towards(hu) - hu, -0.5));
  if (hu < own_.window_low) return share_of(hu - own_.window_low);
  return {};
}

double HuShares::at(int i, int j, int k) const {
  const grid::Grid<std::int16_t>& v = volume_.voxels;
  const int hu = detail::load_voxel(v.voxels[v.index(i, j, k)]);
  if (const std::optional<double> known = of_value(hu)) return *known;
  bool below = false;
  int above = 0, count = 0;
  const auto look = [&](int x, int y, int z) {
    const int beside = v.contains(x, y, z) ? int(detail::load_voxel(v.voxels[v.index(x, y, z)])) : haptic_beyond_hu;
    below = below || beside < own_.window_low;
    if (beside <= own_.window_high) return;
    above = count++ == 0 ? beside : std::min(above, beside);
  };
  for (const int d : {-1, 1}) {
    look(i + d, j, k);
    look(i, j + d, k);
    look(i, j, k + d);
  }
  return share_of(below || count == 0 ? hu - own_.window_low : top_towards(above) - hu);
}

}  // namespace trephine::voxel
