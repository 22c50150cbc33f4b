// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "surface/trimesh.h"

namespace trephine::shapes {

/// A box of n x n squares a side, corner at `at`, outwards; each square two triangles.
inline surface::TriMesh box(Vec3 at, Vec3 size, int n = 1) {
  surface::TriMesh m;
  std::vector<std::uint32_t> number((n + 1) * (n + 1) * (n + 1), 0xffffffffu);
  const auto point = [&](int i, int j, int k) {
    auto& p = number[(k * (n + 1) + j) * (n + 1) + i];
    if (p == 0xffffffffu) {
      p = std::uint32_t(m.points_mm.size());
      m.points_mm.push_back(at + Vec3{size.x * i / n, size.y * j / n, size.z * k / n});
    }
    return p;
  };
  for (int axis = 0; axis < 3; ++axis)
    for (const int side : {0, n})
      for (int u = 0; u < n; ++u)
        for (int v = 0; v < n; ++v) {
          const auto corner = [&](int du, int dv) {
            int i[3];
            i[axis] = side;
            i[(axis + 1) % 3] = u + du;
            i[(axis + 2) % 3] = v + dv;
            return point(i[0], i[1], i[2]);
          };
          std::array<std::uint32_t, 4> c{corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)};
          if (side == 0) std::swap(c[1], c[3]);
          m.triangles.push_back({c[0], c[1], c[2]});
          m.triangles.push_back({c[0], c[2], c[3]});
        }
  return m;
}

}  // namespace trephine::shapes
