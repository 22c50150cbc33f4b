// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/vertex_normals.h"

namespace trephine::surface {

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
