// SPDX-License-Identifier: GPL-3.0-or-later
#include "fluoro/carm.h"

#include <algorithm>
#include <cmath>

namespace trephine::fluoro {
namespace {

constexpr double far_mm = 2000;  // before the centre: where parallel beams begin

}  // namespace

CArm::CArm(const CArmParams& p, int size)
    : centre_{p.centre_mm[0], p.centre_mm[1], p.centre_mm[2]},
      to_centre_(p.source_to_centre_mm),
      to_detector_(p.source_to_detector_mm),
      pixel_mm_(p.detector_mm / size),
      size_(size) {
  using View = CArmParams::View;
  const bool free = p.view == View::free;
  const double orbit = (free                      ? p.orbit_deg
                        : p.view == View::lateral ? 90
                        : p.view == View::oblique ? 45
                                                  : 0) *
                       M_PI / 180;
  const double tilt = (free ? p.tilt_deg : 0) * M_PI / 180;
  right_ = {std::cos(orbit), std::sin(orbit), 0};
  const Vec3 level{-std::sin(orbit), std::cos(orbit), 0}, head{0, 0, 1};
  beam_ = level * std::cos(tilt) + head * std::sin(tilt);
  up_ = head * std::cos(tilt) - level * std::sin(tilt);
}

CArm::Ray CArm::ray(double x, double y) const {
  const double half = 0.5 * size_;
  const Vec3 across = right_ * ((x - half) * pixel_mm_) + up_ * ((half - y) * pixel_mm_);
  if (!(to_centre_ > 0)) return {centre_ + across - beam_ * far_mm, beam_};
  return {centre_ - beam_ * to_centre_, normalized(beam_ * to_detector_ + across)};
}

std::array<double, 2> CArm::project(Vec3 p) const {
  const Vec3 d = p - centre_;
  const double larger = to_centre_ > 0 ? to_detector_ / (to_centre_ + dot(d, beam_)) : 1;
  const double half = 0.5 * size_;
  return {half + dot(d, right_) * larger / pixel_mm_, half - dot(d, up_) * larger / pixel_mm_};
}

std::array<const char*, 2> CArm::side_letters() const {
  constexpr double mostly = 0.6;
  if (std::abs(right_.x) >= mostly) return right_.x > 0 ? std::array{"R", "L"} : std::array{"L", "R"};
  return right_.y > 0 ? std::array{"A", "P"} : std::array{"P", "A"};
}

double chord_mm(const MetalRod& rod, const CArm::Ray& ray) {
  const double length = norm(rod.tail_mm - rod.tip_mm), radius = 0.5 * rod.diameter_mm;
  if (!(length > 0)) return 0;
  const Vec3 axis = (rod.tail_mm - rod.tip_mm) / length, from = ray.from_mm - rod.tip_mm;
  double low = -1e300, high = 1e300;
  // Between the two ends.
  const double along = dot(ray.direction, axis), at = dot(from, axis);
  if (std::abs(along) < 1e-12) {
    if (at < 0 || at > length) return 0;
  } else {
    const double a = -at / along, b = (length - at) / along;
    low = std::min(a, b);
    high = std::max(a, b);
  }
  // Within the mantle.
  const Vec3 d = ray.direction - axis * along, f = from - axis * at;
  const double dd = dot(d, d), df = dot(d, f), ff = dot(f, f) - radius * radius;
  if (dd < 1e-18) return ff < 0 ? std::max(0.0, high - low) : 0;
  const double root = df * df - dd * ff;
  if (root <= 0) return 0;
  low = std::max(low, (-df - std::sqrt(root)) / dd);
  high = std::min(high, (-df + std::sqrt(root)) / dd);
  return std::max(0.0, high - low);
}

}  // namespace trephine::fluoro
