// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "boolean/cut_surface.h"
#include "surface/point_triangle.h"

namespace trephine::boolean {
namespace {

/// The part of a convex polygon where sign * z >= sign * limit.
std::vector<Vec3> clipped(const std::vector<Vec3>& in, double sign, double limit) {
  std::vector<Vec3> out;
  for (std::size_t i = 0; i < in.size(); ++i) {
    const Vec3 a = in[i], b = in[(i + 1) % in.size()];
    const double fa = sign * (a.z - limit), fb = sign * (b.z - limit);
    if (fa >= 0) out.push_back(a);
    if ((fa > 0 && fb < 0) || (fa < 0 && fb > 0)) out.push_back(a + (b - a) * (fa / (fa - fb)));
  }
  return out;
}

/// Least distance of the polygon's shadow along z from the z axis.
double from_axis(const std::vector<Vec3>& polygon) {
  double least2 = std::numeric_limits<double>::infinity();
  const auto flat = [](Vec3 p) { return Vec3{p.x, p.y, 0}; };
  for (std::size_t i = 0; i < polygon.size(); ++i)
    least2 = std::min(least2, surface::nearest_on_triangle({}, flat(polygon[0]), flat(polygon[i]),
                                                           flat(polygon[(i + 1) % polygon.size()]))
                                  .squared_mm2);
  return std::sqrt(least2);
}

}  // namespace

double free_radius_mm(const surface::TriMesh& surface, const Cutter& c) {
  const bool has_axis = c.kind == Cutter::Kind::cylinder || c.kind == Cutter::Kind::cone;
  double least = std::numeric_limits<double>::infinity();
  if (!has_axis) {
    Vec3 centre = c.position_mm;
    if (c.kind == Cutter::Kind::mesh)
      centre = (surface::bounds_of(*c.mesh).min_mm + surface::bounds_of(*c.mesh).max_mm) / 2;
    const Vec3 p = centre - surface.origin_mm;
    for (const auto& t : surface.triangles)
      least = std::min(least, surface::nearest_on_triangle(p, surface.points_mm[t[0]], surface.points_mm[t[1]],
                                                           surface.points_mm[t[2]])
                                  .squared_mm2);
    return std::sqrt(least);
  }
  constexpr double end_mm = 0.1;
  const Vec3 w = normalized(c.direction);
  const Vec3 u = normalized(cross(std::abs(w.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}, w));
  const Mat3 frame{{u, cross(w, u), w}};
  const double from = -c.above_mm + end_mm, to = c.depth_mm - end_mm;
  const Vec3 shift = surface.origin_mm - c.position_mm;
  for (const auto& t : surface.triangles) {
    std::vector<Vec3> p;
    for (const std::uint32_t v : t) p.push_back(transpose_times(frame, surface.points_mm[v] + shift));
    if (std::min({p[0].z, p[1].z, p[2].z}) > to || std::max({p[0].z, p[1].z, p[2].z}) < from) continue;
    p = clipped(clipped(p, 1, from), -1, to);
    if (!p.empty()) least = std::min(least, from_axis(p));
  }
  return least;
}

}  // namespace trephine::boolean
