// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/arc.h"

#include <algorithm>
#include <cmath>

namespace trephine::surface {
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

Arc without_ridges(const Arc& arc, Vec3 centre, double spared_mm, double width_mm, double least_mm) {
  const std::size_t n = arc.points_mm.size();
  std::vector<double> radius(n), along(n), lowest(n);
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 from = arc.points_mm[i] - centre;
    radius[i] = norm(from);
    if (i == 0) continue;
    const Vec3 before = arc.points_mm[i - 1] - centre;
    const double turned = std::atan2(norm(cross(before, from)), dot(before, from));
    along[i] = along[i - 1] + turned * std::min(radius[i], radius[i - 1]);
  }
  // An opening of the radius: the least within the width, then the most of that.
  const auto over_width = [&](const std::vector<double>& values, std::size_t i, auto better) {
    double best = values[i];
    for (std::size_t k = i; k-- > 0 && along[i] - along[k] <= 0.5 * width_mm;) best = better(best, values[k]);
    for (std::size_t k = i + 1; k < n && along[k] - along[i] <= 0.5 * width_mm; ++k) best = better(best, values[k]);
    return best;
  };
  for (std::size_t i = 0; i < n; ++i)
    lowest[i] = over_width(radius, i, [](double a, double b) { return std::min(a, b); });
  Arc out = arc;
  for (std::size_t i = 0; i < n; ++i) {
    if (arc.start < n && std::abs(along[i] - along[arc.start]) < spared_mm) continue;
    const double opened = over_width(lowest, i, [](double a, double b) { return std::max(a, b); });
    if (radius[i] - opened > least_mm) out.points_mm[i] = centre + (arc.points_mm[i] - centre) * (opened / radius[i]);
  }
  return out;
}

}  // namespace trephine::surface
