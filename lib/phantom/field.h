// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <cmath>

#include "base/vec3.h"

namespace trephine::phantom {

/// Implicit shapes, written once for plain numbers and for numbers that carry their gradient (forward differentiation),
/// so that the gradient used for projection is that of the very function sampled. Negative inside; near its zero set
/// each shape is a distance to first order (gradient length 1 to a few percent), farther away a smooth increasing
/// function.

/// A value and its gradient in space.
struct Dual {
  double v = 0, x = 0, y = 0, z = 0;
  Dual() = default;
  Dual(double value) : v(value) {}  // NOLINT: constants mix freely with variables
  Dual(double value, double gx, double gy, double gz) : v(value), x(gx), y(gy), z(gz) {}
};

inline Dual operator+(Dual a, Dual b) { return {a.v + b.v, a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Dual operator-(Dual a, Dual b) { return {a.v - b.v, a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Dual operator-(Dual a) { return {-a.v, -a.x, -a.y, -a.z}; }
inline Dual operator*(Dual a, Dual b) {
  return {a.v * b.v, a.v * b.x + a.x * b.v, a.v * b.y + a.y * b.v, a.v * b.z + a.z * b.v};
}
inline Dual operator/(Dual a, Dual b) {
  const double q = a.v / b.v, i = 1 / b.v;
  return {q, (a.x - q * b.x) * i, (a.y - q * b.y) * i, (a.z - q * b.z) * i};
}
inline Dual chain(double value, double slope, Dual a) { return {value, slope * a.x, slope * a.y, slope * a.z}; }

inline double value(double a) { return a; }
inline double value(const Dual& a) { return a.v; }
inline double lesser(double a, double b) { return a < b ? a : b; }
inline double greater(double a, double b) { return a < b ? b : a; }
inline Dual lesser(const Dual& a, const Dual& b) { return a.v < b.v ? a : b; }
inline Dual greater(const Dual& a, const Dual& b) { return a.v < b.v ? b : a; }
inline double magnitude(double a) { return std::fabs(a); }
inline Dual magnitude(const Dual& a) { return a.v < 0 ? -a : a; }
inline double root(double a) { return std::sqrt(a); }
inline Dual root(const Dual& a) {
  const double r = std::sqrt(a.v);
  return chain(r, 0.5 / r, a);
}
inline double sine(double a) { return std::sin(a); }
inline Dual sine(const Dual& a) { return chain(std::sin(a.v), std::cos(a.v), a); }

template <class S>
S clamped(const S& a, double low, double high) {
  return lesser(greater(a, S(low)), S(high));
}

template <class S>
struct Point {
  S x, y, z;
};
using PointD = Point<double>;

template <class S>
Point<S> operator-(const Point<S>& a, const Vec3& b) {
  return {a.x - S(b.x), a.y - S(b.y), a.z - S(b.z)};
}

/// Smooth union: the lesser, rounded where the two differ by less than k (never by more than k / 4 in value). Exactly
/// the lesser elsewhere. The quadratic polynomial form is well known (I. Quilez, "smooth minimum").
template <class S>
S smooth_union(const S& a, const S& b, double k) {
  const S d = magnitude(a - b);
  if (value(d) >= k) return lesser(a, b);
  const S h = S(k) - d;
  return lesser(a, b) - h * h * S(0.25 / k);
}
template <class S>
S smooth_intersection(const S& a, const S& b, double k) {
  return -smooth_union(S(-a), S(-b), k);
}

template <class S>
S sphere(const Point<S>& p, const Vec3& centre, double radius) {
  const Point<S> q = p - centre;
  return root(q.x * q.x + q.y * q.y + q.z * q.z + S(1e-12)) - S(radius);
}

/// What shapes are worth at least where they lie far away, so that they need not be computed where that is enough.
struct ShapeBounds {
  Vec3 low{1e9, 1e9, 1e9}, high{-1e9, -1e9, -1e9};  ///< a box that holds all of them
  /// First-order distances of ellipsoids and slabs are shorter than true ones, by 2 ab / (a^2 + b^2) at most for
  /// semi-axes a and b (Kantorovich's inequality).
  double ratio = 1;
  double slack_mm = 0;  ///< a quarter of the k of all smooth unions
  void add(Vec3 centre, Vec3 half) {
    low = {std::min(low.x, centre.x - half.x), std::min(low.y, centre.y - half.y), std::min(low.z, centre.z - half.z)};
    high = {std::max(high.x, centre.x + half.x), std::max(high.y, centre.y + half.y),
            std::max(high.z, centre.z + half.z)};
  }
  template <class S>
  double at_least(const Point<S>& p) const {
    const double x = std::max({low.x - value(p.x), value(p.x) - high.x, 0.0}),
                 y = std::max({low.y - value(p.y), value(p.y) - high.y, 0.0}),
                 z = std::max({low.z - value(p.z), value(p.z) - high.z, 0.0});
    return ratio * std::sqrt(x * x + y * y + z * z) - slack_mm;
  }
};

/// |p/r| (|p/r| - 1) / |p/r^2|: first-order distance to an ellipsoid.
template <class S>
S ellipsoid(const Point<S>& p, const Vec3& centre, const Vec3& radii) {
  const Point<S> q = p - centre;
  const S a = q.x * S(1 / radii.x), b = q.y * S(1 / radii.y), c = q.z * S(1 / radii.z);
  const S k0 = root(a * a + b * b + c * c + S(1e-6));
  const S a1 = a * S(1 / radii.x), b1 = b * S(1 / radii.y), c1 = c * S(1 / radii.z);
  const double r = std::min({radii.x, radii.y, radii.z});
  const S k1 = root(a1 * a1 + b1 * b1 + c1 * c1 + S(1e-6 / (r * r)));
  return k0 * (k0 - S(1.0)) / k1;
}

/// A segment from a to b whose radius goes linearly from ra to rb.
template <class S>
S capsule(const Point<S>& p, const Vec3& a, const Vec3& b, double ra, double rb) {
  const Point<S> q = p - a;
  const Vec3 d = b - a;
  const double i = 1 / dot(d, d);
  const S t = clamped(S((q.x * S(d.x) + q.y * S(d.y) + q.z * S(d.z)) * S(i)), 0, 1);
  const S x = q.x - t * S(d.x), y = q.y - t * S(d.y), z = q.z - t * S(d.z);
  return root(x * x + y * y + z * z + S(1e-12)) - (S(ra) + t * S(rb - ra));
}

/// A slab about the plane x = centre.x: elliptical in (y, z) with the semi-axes given, `half` thick on either side, its
/// rim a half circle. Unlike a flat ellipsoid's formula it stays a distance inside.
template <class S>
S slab(const Point<S>& p, const Vec3& centre, double half, double ry, double rz) {
  const Point<S> q = p - centre;
  const double inner_y = ry - half, inner_z = rz - half;
  const S a = q.y * S(1 / inner_y), b = q.z * S(1 / inner_z);
  const S k0 = root(a * a + b * b + S(1e-6));
  const S a1 = a * S(1 / inner_y), b1 = b * S(1 / inner_z);
  const double r = std::min(inner_y, inner_z);
  const S plan = k0 * (k0 - S(1.0)) / root(a1 * a1 + b1 * b1 + S(1e-6 / (r * r)));
  const S beyond = greater(plan, S(0.0));
  return root(beyond * beyond + q.x * q.x + S(1e-6)) - S(half);
}

}  // namespace trephine::phantom
