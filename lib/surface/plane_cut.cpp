// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/plane_cut.h"

#include <cstdint>
#include <utility>

namespace trephine::surface {

std::vector<std::array<Vec3, 2>> plane_cut(const TriMesh& mesh, Vec3 point_mm, Vec3 normal) {
  std::vector<std::array<Vec3, 2>> out;
  std::vector<std::uint8_t> above(mesh.points_mm.size());
  for (std::size_t i = 0; i < above.size(); ++i) above[i] = dot(mesh.world_mm(i) - point_mm, normal) >= 0;
  for (const auto& t : mesh.triangles) {
    if (above[t[0]] == above[t[1]] && above[t[1]] == above[t[2]]) continue;
    const Vec3 p[3] = {mesh.world_mm(t[0]), mesh.world_mm(t[1]), mesh.world_mm(t[2])};
    const double h[3] = {dot(p[0] - point_mm, normal), dot(p[1] - point_mm, normal), dot(p[2] - point_mm, normal)};
    std::array<Vec3, 2> ends;
    std::size_t found = 0;
    for (int e = 0; e < 3 && found < 2; ++e) {
      // The edge is always followed from the same end, so that both of its triangles find the same point.
      int a = e, b = (e + 1) % 3;
      if ((h[a] >= 0) == (h[b] >= 0)) continue;
      if (h[a] >= 0) std::swap(a, b);
      ends[found++] = p[a] + (p[b] - p[a]) * (h[a] / (h[a] - h[b]));
    }
    if (found == 2) out.push_back(ends);
  }
  return out;
}

}  // namespace trephine::surface
