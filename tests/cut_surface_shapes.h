// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Surfaces and cutters for the tests of cutting.
#include <cmath>
#include <string>

#include "base/pi.h"
#include "base/report.h"
#include "boolean/cutter.h"
#include "meshing/validity.h"
#include "random.h"
#include "surface_shapes.h"

namespace trephine::shapes {

inline double figure(const Report& r, const std::string& name) {
  const ParameterValue* v = r.find(name);
  if (!v) return std::nan("");
  if (const auto* i = std::get_if<std::int64_t>(v)) return static_cast<double>(*i);
  return std::get<double>(*v);
}

inline void join(surface::TriMesh& to, const surface::TriMesh& m, bool inside_out = false) {
  const auto n = std::uint32_t(to.points_mm.size());
  for (const Vec3 p : m.points_mm) to.points_mm.push_back(p + (m.origin_mm - to.origin_mm));
  for (const auto& t : m.triangles) {
    if (inside_out)
      to.triangles.push_back({n + t[0], n + t[2], n + t[1]});
    else
      to.triangles.push_back({n + t[0], n + t[1], n + t[2]});
  }
}

/// A lumpy bone of 4 to 9 mm, radius about 40: an outer and an inner surface.
inline surface::TriMesh vault(int level) {
  const auto lumps = [](Vec3 u) { return std::sin(7 * u.x + 1) * std::sin(6 * u.y) + 0.4 * std::sin(19 * u.z); };
  surface::TriMesh m = geodesic(level, [&](Vec3 u) { return 40 + 1.5 * lumps(u); });
  join(m, geodesic(level, [&](Vec3 u) { return 33.5 + 1.2 * lumps({u.y, u.z, u.x}); }), true);
  meshing::snap_to_float32(m);
  return m;
}

/// A plate of that thickness, its upper side at z = 0, n x n cells of 2 triangles a side.
inline surface::TriMesh plate(double side_mm, double thick_mm, int n) {
  surface::TriMesh m;
  const auto point = [&](int i, int j, int k) { return std::uint32_t((k * (n + 1) + j) * (n + 1) + i); };
  for (int k = 0; k < 2; ++k)
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i)
        m.points_mm.push_back({side_mm * (double(i) / n - 0.5), side_mm * (double(j) / n - 0.5), k ? 0 : -thick_mm});
  const auto quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    m.triangles.push_back({a, b, c});
    m.triangles.push_back({a, c, d});
  };
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      quad(point(i, j, 1), point(i + 1, j, 1), point(i + 1, j + 1, 1), point(i, j + 1, 1));
      quad(point(i, j, 0), point(i, j + 1, 0), point(i + 1, j + 1, 0), point(i + 1, j, 0));
    }
  for (int i = 0; i < n; ++i) {
    quad(point(i, 0, 0), point(i + 1, 0, 0), point(i + 1, 0, 1), point(i, 0, 1));
    quad(point(i + 1, n, 0), point(i, n, 0), point(i, n, 1), point(i + 1, n, 1));
    quad(point(0, i + 1, 0), point(0, i, 0), point(0, i, 1), point(0, i + 1, 1));
    quad(point(n, i, 0), point(n, i + 1, 0), point(n, i + 1, 1), point(n, i, 1));
  }
  meshing::snap_to_float32(m);
  return m;
}

/// A ring about the z axis: what a trephine's crown or a craniotome takes away.
inline surface::TriMesh tube(double inner, double outer, double z0, double z1, std::uint32_t n) {
  surface::TriMesh m;
  for (const double z : {z0, z1})
    for (const double r : {inner, outer})
      for (std::uint32_t i = 0; i < n; ++i) {
        const double a = 2 * pi * (i + 0.3) / n;
        m.points_mm.push_back({r * std::cos(a), r * std::sin(a), z});
      }
  const auto band = [&](std::uint32_t from, std::uint32_t to) {
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t j = (i + 1) % n;
      m.triangles.push_back({from * n + i, from * n + j, to * n + j});
      m.triangles.push_back({from * n + i, to * n + j, to * n + i});
    }
  };
  band(1, 3);  // outside
  band(2, 0);  // inside
  band(0, 1);  // below
  band(3, 2);  // above
  return m;
}

inline boolean::Cutter cylinder(Vec3 at, Vec3 direction, double radius, double above, double depth) {
  boolean::Cutter c;
  c.position_mm = at;
  c.direction = direction;
  c.radius_mm = radius;
  c.above_mm = above;
  c.depth_mm = depth;
  return c;
}

/// Any kind in any pose within `reach` of the centre.
inline boolean::Cutter any_cutter(Random& r, double reach) {
  boolean::Cutter c;
  const int kind = int(r() * 5);
  c.kind = kind == 0   ? boolean::Cutter::Kind::sphere
           : kind == 1 ? boolean::Cutter::Kind::cone
           : kind == 2 ? boolean::Cutter::Kind::ellipsoid
                       : boolean::Cutter::Kind::cylinder;
  c.position_mm = r.direction() * (reach * (0.8 + 0.4 * r()));
  // Mostly as a drill stands.
  c.direction = normalized(r() < 0.3 ? r.direction() : normalized(c.position_mm) * -1.0 + r.direction() * 0.5);
  c.across = normalized(cross(c.direction, r.direction()));
  c.radius_mm = r(1, 8);
  c.end_radius_mm = r() < 0.2 ? 0 : r(1, c.radius_mm);
  c.radii_mm = {r(1, 9), r(1, 9), r(1, 9)};
  c.above_mm = r(1, 15);
  c.depth_mm = r(2, 25);
  return c;
}

}  // namespace trephine::shapes
