// SPDX-License-Identifier: GPL-3.0-or-later
#include "boolean/outer_curve.h"

#include <algorithm>
#include <cmath>

#include "base/pi.h"

namespace trephine::boolean::detail {
namespace {

constexpr double step_deg = 0.1;

struct Flat {
  double x = 0, y = 0;
};

/// The distance at which the ray of that direction meets the segment.
std::optional<double> meets(Flat a, Flat b, Flat ray) {
  const double ca = ray.x * a.y - ray.y * a.x, cb = ray.x * b.y - ray.y * b.x;
  if ((ca > 0) == (cb > 0) || ca == cb) return {};
  const double s = ca / (ca - cb);
  const double r = ray.x * (a.x + s * (b.x - a.x)) + ray.y * (a.y + s * (b.y - a.y));
  if (r <= 0) return {};
  return r;
}

/// Keeps the farthest crossing of each ray with one segment.
class Fan {
 public:
  explicit Fan(const Sweep& sweep) : first_(-static_cast<int>(std::lround(sweep.before_deg / step_deg))) {
    const int count = static_cast<int>(std::lround((sweep.before_deg + sweep.after_deg) / step_deg)) + 1;
    for (int i = 0; i < count; ++i) {
      const double angle = (first_ + i) * step_deg * pi / 180;
      rays_.push_back({std::cos(angle), std::sin(angle)});
    }
    farthest_.assign(rays_.size(), 0);
  }

  void add(Flat a, Flat b) {
    const double full = 360 / step_deg;
    double ta = std::atan2(a.y, a.x) * 180 / pi / step_deg, tb = std::atan2(b.y, b.x) * 180 / pi / step_deg;
    if (tb < ta) std::swap(ta, tb);
    if (tb - ta <= full / 2) return add_range(a, b, ta, tb);
    add_range(a, b, tb, ta + full);
    add_range(a, b, tb - full, ta);
  }

  const std::vector<Flat>& rays() const { return rays_; }
  double farthest(std::size_t i) const { return farthest_[i]; }
  std::size_t middle() const { return static_cast<std::size_t>(-first_); }

 private:
  void add_range(Flat a, Flat b, double from, double to) {
    const int low = std::max(0, static_cast<int>(std::floor(from)) - first_);
    const int high = std::min(static_cast<int>(rays_.size()) - 1, static_cast<int>(std::ceil(to)) - first_);
    for (int i = low; i <= high; ++i)
      if (const auto r = meets(a, b, rays_[i])) farthest_[i] = std::max(farthest_[i], *r);
  }

  int first_;
  std::vector<Flat> rays_;
  std::vector<double> farthest_;
};

}  // namespace

OuterCurve outer_curve(const surface::TriMesh& mesh, const Sweep& sweep) {
  const Vec3 normal = cross(sweep.from, sweep.onwards), shift = mesh.origin_mm - sweep.centre_mm;
  std::vector<double> side(mesh.points_mm.size());
  for (std::size_t i = 0; i < side.size(); ++i) side[i] = dot(mesh.points_mm[i] + shift, normal);
  // A point in the plane counts as above it: the cut of a closed surface is closed whatever the rounding.
  const auto crossing = [&](std::uint32_t i, std::uint32_t j) {
    if (i > j) std::swap(i, j);
    const double s = side[i] / (side[i] - side[j]);
    const Vec3 p = mesh.points_mm[i] + shift + s * (mesh.points_mm[j] - mesh.points_mm[i]);
    return Flat{dot(p, sweep.from), dot(p, sweep.onwards)};
  };
  Fan fan(sweep);
  for (const auto& t : mesh.triangles) {
    const bool above[3] = {side[t[0]] >= 0, side[t[1]] >= 0, side[t[2]] >= 0};
    if (above[0] == above[1] && above[1] == above[2]) continue;
    const int lone = above[1] == above[2] ? 0 : above[0] == above[2] ? 1 : 2;
    fan.add(crossing(t[lone], t[(lone + 1) % 3]), crossing(t[lone], t[(lone + 2) % 3]));
  }
  OuterCurve curve;
  curve.start = fan.rays().size();
  for (std::size_t i = 0; i < fan.rays().size(); ++i) {
    if (!(fan.farthest(i) > 0)) continue;
    if (i >= fan.middle()) curve.start = std::min(curve.start, curve.points_mm.size());
    const Flat ray = fan.rays()[i];
    curve.points_mm.push_back(sweep.centre_mm + (sweep.from * ray.x + sweep.onwards * ray.y) * fan.farthest(i));
  }
  return curve;
}

}  // namespace trephine::boolean::detail
