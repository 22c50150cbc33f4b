// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/vertex_normals.h"

#include <algorithm>
#include <cmath>

namespace trephine::surface {

double steady_angle(Vec3 a, Vec3 b) {
  constexpr double unsteady_mm = 0.2;
  const double twice_area = norm(cross(a, b)), longest = std::max({norm(a), norm(b), norm(a - b)});
  if (!(longest > 0)) return 0;
  const double height = twice_area / longest, squared = height * height;
  return std::atan2(twice_area, dot(a, b)) * squared / (squared + unsteady_mm * unsteady_mm);
}

std::vector<Vec3> vertex_normals(const TriMesh& mesh) {
  std::vector<Vec3> n(mesh.points_mm.size());
  for (const auto& t : mesh.triangles)
    for (int c = 0; c < 3; ++c) {
      const Vec3 a = mesh.points_mm[t[c]];
      const Vec3 u = mesh.points_mm[t[(c + 1) % 3]] - a, v = mesh.points_mm[t[(c + 2) % 3]] - a;
      const double weight = dot(u, u) * dot(v, v);
      if (weight > 0) n[t[c]] += cross(u, v) / weight;
    }
  return n;
}

}  // namespace trephine::surface
