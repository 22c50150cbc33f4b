// SPDX-License-Identifier: GPL-3.0-or-later
#include "boolean/overlap.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace trephine::boolean {
namespace {

/// A convex polygon in the plane across the direction, with few corners.
struct Polygon {
  std::array<std::array<double, 2>, 16> p;
  int n = 0;
  void add(double x, double y) {
    if (n < 16) p[n++] = {x, y};  // two triangles need 7; more is rounding
  }
};

/// Keeps where f >= 0; f is linear.
template <class F>
Polygon clipped(const Polygon& in, const F& f) {
  Polygon out;
  for (int i = 0; i < in.n; ++i) {
    const auto &a = in.p[i], &b = in.p[(i + 1) % in.n];
    const double fa = f(a[0], a[1]), fb = f(b[0], b[1]);
    if (fa >= 0) out.add(a[0], a[1]);
    if ((fa > 0 && fb < 0) || (fa < 0 && fb > 0)) {
      const double t = fa / (fa - fb);
      out.add(a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]));
    }
  }
  return out;
}

/// A triangle over its shadow, seen from above.
struct Roof {
  std::array<Vec3, 3> p;  ///< counter-clockwise
  double sign = 0;        ///< +1 looks up, -1 down, 0 edge on
  double x0, x1, y0, y1, z0, z1;
  double slope_x = 0, slope_y = 0;

  explicit Roof(std::array<Vec3, 3> q) : p(q) {
    const Vec3 n = cross(p[1] - p[0], p[2] - p[0]);
    x0 = std::min({p[0].x, p[1].x, p[2].x});
    x1 = std::max({p[0].x, p[1].x, p[2].x});
    y0 = std::min({p[0].y, p[1].y, p[2].y});
    y1 = std::max({p[0].y, p[1].y, p[2].y});
    z0 = std::min({p[0].z, p[1].z, p[2].z});
    z1 = std::max({p[0].z, p[1].z, p[2].z});
    // What is steeper than rounding can tell has no shadow.
    if (std::abs(n.z) <= 1e-13 * norm(n)) return;
    sign = n.z > 0 ? 1 : -1;
    if (sign < 0) std::swap(p[1], p[2]);
    slope_x = -n.x / n.z;
    slope_y = -n.y / n.z;
  }
  double height(double x, double y) const {
    return std::clamp(p[0].z + slope_x * (x - p[0].x) + slope_y * (y - p[0].y), z0, z1);
  }
};

double integral(const Polygon& g, const Roof& r) {
  double sum = 0;
  for (int i = 1; i + 1 < g.n; ++i) {
    const auto &a = g.p[0], &b = g.p[i], &c = g.p[i + 1];
    const double twice = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
    sum += twice / 6 * (r.height(a[0], a[1]) + r.height(b[0], b[1]) + r.height(c[0], c[1]));
  }
  return sum;
}

/// Of the lower of the two, where both have a shadow.
double shared(const Roof& a, const Roof& b) {
  if (a.x0 >= b.x1 || b.x0 >= a.x1 || a.y0 >= b.y1 || b.y0 >= a.y1) return 0;
  Polygon g;
  for (const Vec3 q : a.p) g.add(q.x, q.y);
  for (int i = 0; i < 3 && g.n > 2; ++i) {
    const Vec3 q = b.p[i], e = b.p[(i + 1) % 3] - q;
    g = clipped(g, [&](double x, double y) { return e.x * (y - q.y) - e.y * (x - q.x); });
  }
  if (g.n < 3) return 0;
  double sum;
  if (a.z0 >= b.z1) {
    sum = integral(g, b);
  } else if (b.z0 >= a.z1) {
    sum = integral(g, a);
  } else {
    const Polygon above = clipped(g, [&](double x, double y) { return a.height(x, y) - b.height(x, y); });
    sum = integral(g, a) - integral(above, a) + integral(above, b);
  }
  return a.sign * b.sign * sum;
}

/// The roofs of b by cells of a raster over its shadow.
class Raster {
 public:
  explicit Raster(const std::vector<Roof>& roofs) : roofs_(roofs), seen_(roofs.size(), none) {
    for (const Roof& r : roofs) {
      x0_ = std::min(x0_, r.x0);
      y0_ = std::min(y0_, r.y0);
      x1_ = std::max(x1_, r.x1);
      y1_ = std::max(y1_, r.y1);
    }
    n_ = std::clamp(int(std::sqrt(double(roofs.size()))), 1, 256);
    cells_.resize(std::size_t(n_) * n_);
    for (std::uint32_t i = 0; i < roofs.size(); ++i)
      for_each_cell(roofs[i], [&](std::vector<std::uint32_t>& cell) { cell.push_back(i); });
  }

  double shared_with(const Roof& a, std::uint32_t number) {
    if (a.x0 >= x1_ || a.x1 <= x0_ || a.y0 >= y1_ || a.y1 <= y0_) return 0;
    double sum = 0;
    for_each_cell(a, [&](std::vector<std::uint32_t>& cell) {
      for (const std::uint32_t i : cell)
        if (seen_[i] != number) {
          seen_[i] = number;
          sum += shared(a, roofs_[i]);
        }
    });
    return sum;
  }

 private:
  static constexpr std::uint32_t none = 0xffffffffu;
  template <class F>
  void for_each_cell(const Roof& r, const F& f) {
    const auto cell = [&](double v, double lo, double hi) {
      return std::clamp(int((v - lo) / (hi - lo) * n_), 0, n_ - 1);
    };
    const auto at = [&](double v, double lo, double hi) { return cell(std::clamp(v, lo, hi), lo, hi); };
    for (int j = at(r.y0, y0_, y1_); j <= at(r.y1, y0_, y1_); ++j)
      for (int i = at(r.x0, x0_, x1_); i <= at(r.x1, x0_, x1_); ++i) f(cells_[std::size_t(j) * n_ + i]);
  }
  const std::vector<Roof>& roofs_;
  std::vector<std::uint32_t> seen_;
  std::vector<std::vector<std::uint32_t>> cells_;
  double x0_ = 1e300, y0_ = 1e300, x1_ = -1e300, y1_ = -1e300;
  int n_ = 1;
};

}  // namespace

double overlap_mm3(const surface::TriMesh& a, const surface::TriMesh& b, Vec3 direction) {
  const Vec3 w = normalized(direction);
  const Vec3 u = normalized(cross(std::abs(w.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}, w));
  const Mat3 frame{{u, cross(w, u), w}};
  // About b's middle, so that little cancels.
  const surface::Bounds box = surface::bounds_of(b);
  const Vec3 middle = (box.min_mm + box.max_mm) / 2;
  const auto roof = [&](const surface::TriMesh& m, std::size_t t) {
    std::array<Vec3, 3> p;
    for (int c = 0; c < 3; ++c) p[c] = transpose_times(frame, m.points_mm[m.triangles[t][c]] + (m.origin_mm - middle));
    return Roof(p);
  };
  std::vector<Roof> roofs;
  for (std::size_t t = 0; t < b.triangles.size(); ++t) {
    roofs.push_back(roof(b, t));
    if (roofs.back().sign == 0) roofs.pop_back();
  }
  if (roofs.empty()) return 0;
  Raster raster(roofs);
  double sum = 0;
  for (std::size_t t = 0; t < a.triangles.size(); ++t) {
    const Roof r = roof(a, t);
    if (r.sign != 0) sum += raster.shared_with(r, std::uint32_t(t));
  }
  return sum;
}

}  // namespace trephine::boolean
