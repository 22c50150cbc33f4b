// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/arc.h"

#include <algorithm>
#include <cmath>

namespace trephine {
namespace {

constexpr double divider_mm = 2;

// Where the segment from a (nearer than r to p) to b (not nearer) is at the distance r from p.
Vec3 leaves_sphere(Vec3 a, Vec3 b, Vec3 p, double r) {
  const Vec3 d = b - a, f = a - p;
  const double dd = dot(d, d), df = dot(d, f), ff = dot(f, f) - r * r;
  if (!(dd > 0)) return b;
  const double s = (-df + std::sqrt(std::max(0.0, df * df - dd * ff))) / dd;
  return a + d * std::clamp(s, 0.0, 1.0);
}

}  // namespace

std::optional<Vec3> point_along(const Arc& arc, double length_mm) {
  if (arc.start >= arc.points_mm.size()) return {};
  Vec3 p = arc.points_mm[arc.start];
  std::size_t next = arc.start + 1;
  for (double left = length_mm; left > 1e-9;) {
    const double step = std::min(left, divider_mm);
    Vec3 before = p;
    while (next < arc.points_mm.size() && norm(arc.points_mm[next] - p) < step) before = arc.points_mm[next++];
    if (next == arc.points_mm.size()) return {};
    p = leaves_sphere(before, arc.points_mm[next], p, step);
    left -= step;
  }
  return p;
}

}  // namespace trephine
