// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

#include "sampled_grid.h"
#include "segmentation/segment.h"

// Small volumes, and what segment makes of them.
namespace trephine::segment_test {

inline grid::Lattice lattice(int nx, int ny, int nz, Vec3 spacing = {0.5, 0.5, 1.0}) {
  grid::Lattice l;
  l.size = {nx, ny, nz};
  l.spacing_mm = spacing;
  l.origin_mm = {-0.5 * (nx - 1) * spacing.x, -0.5 * (ny - 1) * spacing.y, -0.5 * (nz - 1) * spacing.z};
  return l;
}

/// Rounded to int16.
inline grid::Grid<std::int16_t> rounded(const grid::Grid<float>& g) {
  grid::Grid<std::int16_t> out(g);
  for (std::size_t v = 0; v < g.count(); ++v) out.voxels[v] = std::int16_t(std::lround(g.voxels[v]));
  return out;
}

inline grid::Field run(const grid::HuVolume& volume, const segmentation::SegmentParams& params,
                       const segmentation::SegmentMasks& masks = {}) {
  grid::Field field = segmentation::segment(volume, masks, params).value;
  for (float f : field.voxels) EXPECT_TRUE(std::isfinite(f) && f != 0);
  return field;
}

inline bool holds(const grid::Field& f, Vec3 world) {
  const Vec3 p = f.to_index(world);
  const int i = int(std::lround(p.x)), j = int(std::lround(p.y)), k = int(std::lround(p.z));
  return f.contains(i, j, k) && f.at(i, j, k) > 0;
}

}  // namespace trephine::segment_test
