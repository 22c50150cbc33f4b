// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <utility>

#include "boolean/cutter.h"
#include "boolean/cutter_shape.h"
#include "surface/point_to_mesh.h"

namespace trephine::boolean {
namespace {

struct Flat {
  double s, r;  ///< along the axis from the outer end, and from the axis
};

double to_segment(Flat p, Flat a, Flat b) {
  const double ds = b.s - a.s, dr = b.r - a.r, length2 = ds * ds + dr * dr;
  const double t = length2 > 0 ? std::clamp(((p.s - a.s) * ds + (p.r - a.r) * dr) / length2, 0.0, 1.0) : 0.0;
  return std::hypot(p.s - a.s - t * ds, p.r - a.r - t * dr);
}

/// In the half-plane through the axis it is a trapezium, of which the axis itself is no border.
double frustum_distance(Flat p, double length, double r0, double r1) {
  const double d = std::min(
      {to_segment(p, {0, 0}, {0, r0}), to_segment(p, {0, r0}, {length, r1}), to_segment(p, {length, r1}, {length, 0})});
  const bool inside = p.s >= 0 && p.s <= length && p.r * length <= r0 * length + (r1 - r0) * p.s;
  return inside ? -d : d;
}

/// The distance from a point to an ellipse, after [Eberly2013]. The nearest point is e^2 y / (e^2 + t), where t is the
/// only root beyond -e2^2 of a falling function. It is sought by bisection of u = 1 + t / e2^2, which keeps all digits
/// near 0.
double ellipsoid_distance(std::array<double, 3> e, std::array<double, 3> y) {
  for (double& v : y) v = std::abs(v);
  for (const auto& [i, j] : {std::pair(0, 1), std::pair(1, 2), std::pair(0, 1)})
    if (e[i] < e[j]) {
      std::swap(e[i], e[j]);
      std::swap(y[i], y[j]);
    }
  for (double& v : y) v = std::max(v, 1e-13 * e[0]);  // in general position; moves the answer by no more
  const double z0 = y[0] / e[0], z1 = y[1] / e[1], z2 = y[2] / e[2];
  const bool inside = z0 * z0 + z1 * z1 + z2 * z2 < 1;
  const double r0 = (e[0] / e[2]) * (e[0] / e[2]), r1 = (e[1] / e[2]) * (e[1] / e[2]);
  const double more0 = (e[0] - e[2]) * (e[0] + e[2]) / (e[2] * e[2]);
  const double more1 = (e[1] - e[2]) * (e[1] + e[2]) / (e[2] * e[2]);
  double low = z2, high = inside ? 1 : std::sqrt(r0 * z0 * r0 * z0 + r1 * z1 * r1 * z1 + z2 * z2);
  double u = high;
  for (int i = 0; i < 2000; ++i) {
    u = low + (high - low) / 2;
    if (u <= low || u >= high) break;
    const double a = r0 * z0 / (u + more0), b = r1 * z1 / (u + more1), c = z2 / u;
    (a * a + b * b + c * c > 1 ? low : high) = u;
  }
  const double dx = r0 * y[0] / (u + more0) - y[0], dy = r1 * y[1] / (u + more1) - y[1], dz = y[2] / u - y[2];
  const double d = std::sqrt(dx * dx + dy * dy + dz * dz);
  return inside ? -d : d;
}

struct MeshDistance {
  std::shared_ptr<const surface::TriMesh> mesh;
  surface::PointToMesh tree;
  explicit MeshDistance(std::shared_ptr<const surface::TriMesh> m) : mesh(std::move(m)), tree(*mesh) {}
};

}  // namespace

surface::DistanceFunction distance_to(const Cutter& c) {
  const Vec3 at = c.position_mm;
  switch (c.kind) {
    case Cutter::Kind::mesh: {
      const auto own = std::make_shared<const MeshDistance>(c.mesh);
      return [own](Vec3 p) { return own->tree.signed_distance_mm(p); };
    }
    case Cutter::Kind::sphere:
      return [at, r = c.radius_mm](Vec3 p) { return norm(p - at) - r; };
    case Cutter::Kind::ellipsoid:
      return [at, f = frame_of(c), r = c.radii_mm](Vec3 p) {
        const Vec3 l = transpose_times(f, p - at);
        return ellipsoid_distance(r, {l.x, l.y, l.z});
      };
    default: {
      const Vec3 w = normalized(c.direction);
      const double length = c.above_mm + c.depth_mm, r0 = start_radius_mm(c), r1 = far_radius_mm(c);
      return [start = at - w * c.above_mm, w, length, r0, r1](Vec3 p) {
        const Vec3 l = p - start;
        const double s = dot(l, w);
        return frustum_distance({s, norm(l - w * s)}, length, r0, r1);
      };
    }
  }
}

}  // namespace trephine::boolean
