// SPDX-License-Identifier: GPL-3.0-or-later
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/intersections.h>

#include <algorithm>
#include <cmath>

#include "meshing/exact.h"

namespace trephine::meshing {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;

Point exact(Vec3 p) { return {p.x, p.y, p.z}; }

/// The sign of the determinant, 1 or -1, where Shewchuk's first error bound makes it certain; else 0.
int quick_side(Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
  const Vec3 u = a - d, v = b - d, w = c - d;
  const double vw = v.x * w.y, wv = w.x * v.y, wu = w.x * u.y, uw = u.x * w.y, uv = u.x * v.y, vu = v.x * u.y;
  const double det = u.z * (vw - wv) + v.z * (wu - uw) + w.z * (uv - vu);
  const double permanent = (std::abs(vw) + std::abs(wv)) * std::abs(u.z) +
                           (std::abs(wu) + std::abs(uw)) * std::abs(v.z) +
                           (std::abs(uv) + std::abs(vu)) * std::abs(w.z);
  const double bound = 8e-16 * permanent;
  return det > bound ? 1 : det < -bound ? -1 : 0;
}

/// Whether all points certainly lie strictly on one side of the triangle's plane.
template <std::size_t N>
bool apart(const std::array<Vec3, 3>& t, const std::array<Vec3, N>& points) {
  const int first = quick_side(t[0], t[1], t[2], points[0]);
  if (first == 0) return false;
  for (std::size_t i = 1; i < N; ++i)
    if (quick_side(t[0], t[1], t[2], points[i]) != first) return false;
  return true;
}

Kernel::Triangle_3 exact(const std::array<Vec3, 3>& t) { return {exact(t[0]), exact(t[1]), exact(t[2])}; }

bool overlap_at_edge(Vec3 p, Vec3 q, Vec3 a, Vec3 b) {
  if (quick_side(p, q, a, b) != 0) return false;
  return CGAL::coplanar(exact(p), exact(q), exact(a), exact(b)) &&
         CGAL::coplanar_orientation(exact(p), exact(q), exact(a), exact(b)) == CGAL::POSITIVE;
}

/// Whether two triangles that share their first point also meet elsewhere. Then the side opposite that point of one of
/// them meets the other.
bool meet_beyond_point(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b) {
  if (apart(a, std::array<Vec3, 2>{b[1], b[2]}) || apart(b, std::array<Vec3, 2>{a[1], a[2]})) return false;
  return CGAL::do_intersect(exact(a), Kernel::Segment_3(exact(b[1]), exact(b[2]))) ||
         CGAL::do_intersect(exact(b), Kernel::Segment_3(exact(a[1]), exact(a[2])));
}

}  // namespace

bool on_a_line(Vec3 a, Vec3 b, Vec3 c) {
  const Vec3 n = cross(b - a, c - a);
  const double scale = std::max(dot(b - a, b - a), dot(c - a, c - a));
  if (dot(n, n) > 1e-24 * scale * scale) return false;
  return CGAL::collinear(exact(a), exact(b), exact(c));
}

bool triangles_intersect(const std::array<std::uint32_t, 3>& ia, const std::array<Vec3, 3>& a,
                         const std::array<std::uint32_t, 3>& ib, const std::array<Vec3, 3>& b) {
  int shared = 0, sa[3], sb[3];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (ia[i] == ib[j]) {
        sa[shared] = i;
        sb[shared++] = j;
        break;
      }
  if (shared == 0) {
    if (apart(a, b) || apart(b, a)) return false;
    return CGAL::do_intersect(exact(a), exact(b));
  }
  if (shared == 1)
    return meet_beyond_point({a[sa[0]], a[(sa[0] + 1) % 3], a[(sa[0] + 2) % 3]},
                             {b[sb[0]], b[(sb[0] + 1) % 3], b[(sb[0] + 2) % 3]});
  if (shared == 2) return overlap_at_edge(a[sa[0]], a[sa[1]], a[3 - sa[0] - sa[1]], b[3 - sb[0] - sb[1]]);
  return true;
}

}  // namespace trephine::meshing
