// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cmath>
#include <cstdint>

#include "base/pi.h"
#include "surface/trimesh.h"

// Surfaces whose pictures are known.
namespace trephine::picture_test {

inline surface::TriMesh sphere(double radius, Vec3 center, int rings = 64) {
  surface::TriMesh m;
  m.origin_mm = center;
  const int sectors = 2 * rings;
  m.points_mm.push_back({0, 0, radius});
  for (int i = 1; i < rings; ++i)
    for (int j = 0; j < sectors; ++j) {
      const double a = pi * i / rings, b = 2 * pi * j / sectors;
      m.points_mm.push_back(Vec3{std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a)} * radius);
    }
  m.points_mm.push_back({0, 0, -radius});
  const auto at = [&](int i, int j) { return std::uint32_t(1 + (i - 1) * sectors + j % sectors); };
  const auto last = std::uint32_t(m.points_mm.size() - 1);
  for (int j = 0; j < sectors; ++j) {
    m.triangles.push_back({0, at(1, j), at(1, j + 1)});
    m.triangles.push_back({last, at(rings - 1, j + 1), at(rings - 1, j)});
    for (int i = 1; i + 1 < rings; ++i) {
      m.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      m.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return m;
}

}  // namespace trephine::picture_test
