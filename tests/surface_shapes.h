// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Analytic test surfaces.
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <utility>

#include "surface/trimesh.h"

namespace trephine::shapes {

/// Geodesic sphere: 20 * 4^level triangles, points moved by `displace` (unit direction to radius).
inline surface::TriMesh geodesic(int level, const std::function<double(Vec3)>& radius_mm, Vec3 centre = {}) {
  const double g = (1 + std::sqrt(5.0)) / 2;
  surface::TriMesh m;
  m.origin_mm = centre;
  m.points_mm = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                 {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  m.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                 {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                 {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (Vec3& p : m.points_mm) p = normalized(p);
  for (int l = 0; l < level; ++l) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middle;
    const auto between = [&](std::uint32_t a, std::uint32_t b) {
      const auto [it, fresh] = middle.try_emplace(std::minmax(a, b), std::uint32_t(m.points_mm.size()));
      if (fresh) m.points_mm.push_back(normalized(m.points_mm[a] + m.points_mm[b]));
      return it->second;
    };
    std::vector<std::array<std::uint32_t, 3>> finer;
    for (const auto& t : m.triangles) {
      const std::uint32_t ab = between(t[0], t[1]), bc = between(t[1], t[2]), ca = between(t[2], t[0]);
      finer.insert(finer.end(), {{t[0], ab, ca}, {t[1], bc, ab}, {t[2], ca, bc}, {ab, bc, ca}});
    }
    m.triangles = std::move(finer);
  }
  for (Vec3& p : m.points_mm) p = p * radius_mm(p);
  return m;
}

inline surface::TriMesh sphere(int level, double radius_mm, Vec3 centre = {}) {
  return geodesic(
      level, [=](Vec3) { return radius_mm; }, centre);
}

/// A lumpy surface with detail of a few millimetres at radius 90 mm: as hard for the tree as a skull's outside.
inline surface::TriMesh lumpy(int level, Vec3 centre = {}) {
  return geodesic(
      level,
      [](Vec3 u) {
        return 90 + 6 * std::sin(9 * u.x + 1) * std::sin(8 * u.y) + 2 * std::sin(31 * u.z) * std::cos(29 * u.x) +
               0.7 * std::sin(83 * u.y + 40 * u.x);
      },
      centre);
}

inline surface::TriMesh box(Vec3 lo, Vec3 hi) {
  surface::TriMesh m;
  for (int i = 0; i < 8; ++i) m.points_mm.push_back({i & 1 ? hi.x : lo.x, i & 2 ? hi.y : lo.y, i & 4 ? hi.z : lo.z});
  m.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                 {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return m;
}

/// A square of side `side_mm` at height z, n x n cells, facing +z.
inline surface::TriMesh plane(double side_mm, double z_mm, int n) {
  surface::TriMesh m;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) m.points_mm.push_back({side_mm * i / n, side_mm * j / n, z_mm});
  for (std::uint32_t j = 0; j < std::uint32_t(n); ++j)
    for (std::uint32_t i = 0; i < std::uint32_t(n); ++i) {
      const std::uint32_t a = j * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
      m.triangles.push_back({a, b, d});
      m.triangles.push_back({a, d, c});
    }
  return m;
}

}  // namespace trephine::shapes
