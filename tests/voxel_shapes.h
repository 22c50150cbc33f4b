// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Analytic solids for the haptic volume's tests: their surface as a mesh, points on it, their signed distance.
#include <cmath>
#include <cstdint>
#include <functional>
#include <random>
#include <vector>

#include "base/params.h"
#include "surface/distance_function.h"
#include "surface_shapes.h"
#include "voxel/voxelize.h"

namespace trephine::shapes {

inline double uniform(std::mt19937_64& rng, double lo, double hi) {
  return lo + (hi - lo) * double(rng() >> 11) * 0x1p-53;
}
inline Vec3 unit_vector(std::mt19937_64& rng) {
  const double z = uniform(rng, -1, 1), a = uniform(rng, 0, 2 * M_PI), r = std::sqrt(1 - z * z);
  return {r * std::cos(a), r * std::sin(a), z};
}
/// A random rotation.
inline Mat3 turned(std::mt19937_64& rng) {
  Mat3 m;
  m.column[2] = unit_vector(rng);
  m.column[0] = normalized(cross(m.column[2], unit_vector(rng)));
  m.column[1] = cross(m.column[2], m.column[0]);
  return m;
}

/// Points of a surface with the normals there.
struct SurfacePoint {
  Vec3 point_mm, normal;
};

struct Solid {
  surface::TriMesh mesh;
  surface::DistanceFunction distance;
  std::vector<SurfacePoint> points;
};

inline Solid ball(double radius_mm, Vec3 centre, int points, std::mt19937_64& rng, int level = 5) {
  Solid s;
  s.mesh = sphere(level, radius_mm, centre);
  s.distance = [=](Vec3 p) { return norm(p - centre) - radius_mm; };
  for (int n = 0; n < points; ++n) {
    const Vec3 u = unit_vector(rng);
    s.points.push_back({centre + radius_mm * u, u});
  }
  return s;
}

/// Its distance is first order only.
inline Solid ellipsoid(Vec3 radii_mm, Vec3 centre, const Mat3& pose, int points, std::mt19937_64& rng) {
  Solid s;
  s.mesh = sphere(5, 1);
  s.mesh.origin_mm = centre;
  for (Vec3& p : s.mesh.points_mm) p = pose * Vec3{p.x * radii_mm.x, p.y * radii_mm.y, p.z * radii_mm.z};
  s.distance = [=](Vec3 p) {
    const Vec3 q = transpose_times(pose, p - centre);
    const Vec3 a{q.x / radii_mm.x, q.y / radii_mm.y, q.z / radii_mm.z};
    const Vec3 b{a.x / radii_mm.x, a.y / radii_mm.y, a.z / radii_mm.z};
    return norm(b) > 0 ? norm(a) * (norm(a) - 1) / norm(b) : -radii_mm.x;
  };
  for (int n = 0; n < points; ++n) {
    const Vec3 u = unit_vector(rng);
    s.points.push_back({centre + pose * Vec3{u.x * radii_mm.x, u.y * radii_mm.y, u.z * radii_mm.z},
                        pose * normalized({u.x / radii_mm.x, u.y / radii_mm.y, u.z / radii_mm.z})});
  }
  return s;
}

/// A box of these half sides; points on its faces (of `axis`, or all) keep `rim_mm` away from the edges.
inline Solid block(Vec3 half_mm, Vec3 centre, const Mat3& pose, double rim_mm, int points, std::mt19937_64& rng,
                   int only_axis = -1) {
  Solid s;
  s.mesh = box(-half_mm, half_mm);
  s.mesh.origin_mm = centre;
  for (Vec3& p : s.mesh.points_mm) p = pose * p;
  s.distance = [=](Vec3 p) {
    const Vec3 q = transpose_times(pose, p - centre);
    Vec3 beyond;
    double inside = -1e300;
    for (int a = 0; a < 3; ++a) {
      const double d = std::abs(q[a]) - half_mm[a];
      beyond[a] = std::max(0.0, d);
      inside = std::max(inside, d);
    }
    return inside > 0 ? norm(beyond) : inside;
  };
  for (int n = 0; n < points; ++n) {
    const int axis = only_axis >= 0 ? only_axis : int(rng() % 3);
    Vec3 q, normal;
    for (int a = 0; a < 3; ++a) q[a] = uniform(rng, -1, 1) * (half_mm[a] - rim_mm);
    normal[axis] = rng() % 2 ? 1 : -1;
    q[axis] = half_mm[axis] * normal[axis];
    s.points.push_back({centre + pose * q, pose * normal});
  }
  return s;
}

/// Voxels of that spacing around a box, along `direction`.
inline grid::Lattice lattice_around(const surface::Bounds& bounds, Vec3 spacing_mm, const Mat3& direction = {},
                                    Vec3 anchor_mm = {}) {
  voxel::VoxelizeParams params;
  params.spacing_mm = {spacing_mm.x, spacing_mm.y, spacing_mm.z};
  surface::Bounds region = bounds;
  region.min_mm += Vec3{-3, -3, -3};
  region.max_mm += Vec3{3, 3, 3};
  return voxel::haptic_lattice(region, direction, anchor_mm, params);
}

/// Offsets along the normals at which a value falls through 1/2, nearest to the surface; `missed` counts points without
/// one within `reach_mm`.
struct Offsets {
  double bias = 0, rms = 0, worst = 0;
  int missed = 0, count = 0;
};
inline Offsets offsets_of(const std::vector<SurfacePoint>& points, double reach_mm,
                          const std::function<double(Vec3)>& value) {
  Offsets o;
  for (const SurfacePoint& s : points) {
    const double step = reach_mm / 100;
    double found = 1e300;
    double before = value(s.point_mm - reach_mm * s.normal);
    for (int n = -99; n <= 100; ++n) {
      const double after = value(s.point_mm + n * step * s.normal);
      if (before > 0.5 && after <= 0.5) {
        double lo = (n - 1) * step, hi = n * step;
        for (int b = 0; b < 30; ++b) {
          const double middle = (lo + hi) / 2;
          (value(s.point_mm + middle * s.normal) > 0.5 ? lo : hi) = middle;
        }
        if (std::abs(lo) < std::abs(found)) found = lo;
      }
      before = after;
    }
    if (found > 1e200) {
      ++o.missed;
      continue;
    }
    ++o.count;
    o.bias += found;
    o.rms += found * found;
    o.worst = std::max(o.worst, std::abs(found));
  }
  o.bias /= std::max(1, o.count);
  o.rms = std::sqrt(o.rms / std::max(1, o.count));
  return o;
}

}  // namespace trephine::shapes
