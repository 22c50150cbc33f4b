// SPDX-License-Identifier: GPL-3.0-or-later
#include "craniometry/near_distance.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace trephine::craniometry {

grid::Grid<float> near_distance_mm(const grid::Field& f, int reach) {
  const double step = f.spacing_mm.x;
  const float far = float(reach * step);
  grid::Grid<float> squared(f, far * far);
  const std::array<std::array<int, 3>, 3> axes{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  // Each crossing of an edge between voxels tells all voxels around it how near it is.
  const auto tell = [&](int i, int j, int k, int axis, float part) {
    const int ci = i + (axis == 0 && part > 0.5f), cj = j + (axis == 1 && part > 0.5f),
              ck = k + (axis == 2 && part > 0.5f);
    const float x = i + (axis == 0 ? part : 0), y = j + (axis == 1 ? part : 0), z = k + (axis == 2 ? part : 0);
    const float unit = float(step * step);
    const int i0 = std::max(0, ci - reach), i1 = std::min(f.size[0] - 1, ci + reach);
    for (int c = std::max(0, ck - reach); c <= std::min(f.size[2] - 1, ck + reach); ++c)
      for (int b = std::max(0, cj - reach); b <= std::min(f.size[1] - 1, cj + reach); ++b) {
        const float rest = (b - y) * (b - y) + (c - z) * (c - z);
        float* row = squared.voxels.data() + f.index(0, b, c);
        for (int a = i0; a <= i1; ++a) row[a] = std::min(row[a], unit * ((a - x) * (a - x) + rest));
      }
  };
  for (int k = 0; k < f.size[2]; ++k)
    for (int j = 0; j < f.size[1]; ++j)
      for (int i = 0; i < f.size[0]; ++i) {
        const float here = f.at(i, j, k);
        for (int axis = 0; axis < 3; ++axis) {
          const auto& d = axes[axis];
          if (!f.contains(i + d[0], j + d[1], k + d[2])) continue;
          const float there = f.at(i + d[0], j + d[1], k + d[2]);
          if ((here > 0) != (there > 0)) tell(i, j, k, axis, here / (here - there));
        }
      }
  for (std::size_t v = 0; v < squared.voxels.size(); ++v)
    squared.voxels[v] = std::copysign(std::sqrt(squared.voxels[v]), f.voxels[v] > 0 ? 1.f : -1.f);
  return squared;
}

}  // namespace trephine::craniometry
