// SPDX-License-Identifier: GPL-3.0-or-later
#include "segmentation/label_raster.h"

#include <algorithm>
#include <cmath>

namespace trephine::segmentation {
namespace {

constexpr double same_raster_voxels = 0.05;

}  // namespace

std::optional<RasterAlignment> raster_alignment(const grid::Lattice& label, const grid::Lattice& volume) {
  RasterAlignment a;
  const Vec3 first = volume.to_index(label.origin_mm);
  std::array<bool, 3> used{};
  for (int v = 0; v < 3; ++v) {
    int best = 0;
    double most = -1;
    for (int l = 0; l < 3; ++l) {
      const double c = std::abs(dot(volume.direction.column[v], label.direction.column[l]));
      if (c > most) most = c, best = l;
    }
    if (used[best]) return {};
    used[best] = true;
    a.axis[v] = best;
    a.sign[v] = dot(volume.direction.column[v], label.direction.column[best]) < 0 ? -1 : 1;
    if (!(std::abs(first[v]) < 1e6)) return {};
    a.offset[v] = int(std::lround(first[v]));
  }
  for (int corner = 0; corner < 8; ++corner) {
    Vec3 at;
    for (int l = 0; l < 3; ++l) at[l] = corner >> l & 1 ? label.size[l] - 1.0 : 0.0;
    const Vec3 is = volume.to_index(label.to_world_mm(at));
    for (int v = 0; v < 3; ++v)
      a.off_voxels = std::max(a.off_voxels, std::abs(is[v] - (a.offset[v] + a.sign[v] * at[a.axis[v]])));
  }
  if (!(a.off_voxels <= same_raster_voxels)) return {};
  return a;
}

mask::BitMask on_raster(const grid::Mask& label, const grid::Lattice& volume, const RasterAlignment& a) {
  return mask::make_mask(volume, [&](int j, int k, std::uint8_t* row) {
    const int at[3] = {0, j, k};
    int from[3];
    for (int v = 1; v < 3; ++v) {
      const int n = (at[v] - a.offset[v]) * a.sign[v];
      if (n < 0 || n >= label.size[a.axis[v]]) return;
      from[a.axis[v]] = n;
    }
    for (int i = 0; i < volume.size[0]; ++i) {
      const int n = (i - a.offset[0]) * a.sign[0];
      if (n < 0 || n >= label.size[a.axis[0]]) continue;
      from[a.axis[0]] = n;
      row[i] = label.at(from[0], from[1], from[2]);
    }
  });
}

}  // namespace trephine::segmentation
