// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/fan.h"

#include <array>
#include <cmath>

namespace trephine::surface {

bool is_fan(const TriMesh& mesh, const Incidence& incidence, std::uint32_t p) {
  constexpr double margin = 1e-10;
  const std::uint32_t begin = incidence.begin[p], end = incidence.begin[p + 1];
  if (end - begin < 3 || end - begin > 64) return false;
  struct Wing {
    Vec3 b, c, normal;
    double scale;
  };
  std::array<Wing, 64> wings;
  const Vec3 at = mesh.points_mm[p];
  Vec3 sum;
  for (std::uint32_t n = begin; n < end; ++n) {
    const auto& t = mesh.triangles[incidence.triangle[n]];
    const int k = t[0] == p ? 0 : t[1] == p ? 1 : 2;
    Wing& w = wings[n - begin];
    w.b = mesh.points_mm[t[(k + 1) % 3]] - at;
    w.c = mesh.points_mm[t[(k + 2) % 3]] - at;
    w.normal = cross(w.b, w.c);
    w.scale = std::sqrt(dot(w.b, w.b) * dot(w.c, w.c));
    if (!(w.scale > 0)) return false;
    sum += w.normal / w.scale;
  }
  // A direction perpendicular to the sum, and on which side of it each neighbour lies.
  const Vec3 across = std::abs(sum.x) > std::abs(sum.y) ? Vec3{-sum.z, 0, sum.x} : Vec3{0, sum.z, -sum.y};
  const double length = norm(sum), across_length = norm(across);
  int turns = 0;
  for (std::uint32_t n = 0; n < end - begin; ++n) {
    const Wing& w = wings[n];
    if (!(dot(w.normal, sum) > margin * w.scale * length)) return false;
    const double b = dot(w.b, across), c = dot(w.c, across);
    if (!(std::abs(b) > margin * norm(w.b) * across_length) || !(std::abs(c) > margin * norm(w.c) * across_length))
      return false;
    turns += b < 0 && c > 0;
  }
  return turns == 1;
}

}  // namespace trephine::surface
