// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The shapes of phantom/spine.h, which tests of the simulator use without the library of phantoms.
#include <algorithm>
#include <cmath>

#include "base/splitmix64.h"
#include "phantom/spine.h"

namespace trephine::phantom {
namespace spine_shapes {

constexpr double degree = M_PI / 180;
constexpr double needle_out_mm = 80;
constexpr double cone_mm = 5, point_mm = 0.8;                             // the tip of a screw
constexpr double head_radius_mm = 6, head_mm = 13, rod_radius_mm = 2.75;  // the head, and the rod on it

inline double ball(Vec3 d, Vec3 r) {
  const Vec3 s{d.x / r.x, d.y / r.y, d.z / r.z};
  const double k = norm(s), g = norm({s.x / r.x, s.y / r.y, s.z / r.z});
  return k < 1e-9 ? std::min({r.x, r.y, r.z}) : k * (1 - k) / g;
}
inline double rod(Vec3 p, Vec3 a, Vec3 b, double radius) {
  const Vec3 ab = b - a;
  return radius - norm(p - a - ab * std::clamp(dot(p - a, ab) / dot(ab, ab), 0.0, 1.0));
}
inline Vec3 leaning(Vec3 p, double a) {  // about x
  return {p.x, p.y * std::cos(a) - p.z * std::sin(a), p.y * std::sin(a) + p.z * std::cos(a)};
}
inline double screw(Vec3 p, Vec3 tip, Vec3 seat, double radius, bool needle) {
  const Vec3 back = normalized(seat - tip), d = p - tip;
  const double t = dot(d, back), length = norm(seat - tip), r = norm(d - back * t);
  const double wide = point_mm + (radius - point_mm) * std::clamp(t / cone_mm, 0.0, 1.0);
  if (needle) return std::min({wide - r, t, length + needle_out_mm - t});
  return std::max(std::min({wide - r, t, length + 1 - t}),
                  std::min({head_radius_mm - r, t - length, length + head_mm - t}));
}

}  // namespace spine_shapes

inline Spine::Spine(const SpineParams& params) : params_(params), turn_(params.turned_deg * spine_shapes::degree) {
  for (int n = 0; n < params_.vertebrae_count; ++n) vertebrae_.push_back(made(n));
  put_in_screws();
}

inline Spine::Vertebra Spine::made(int n) const {
  // Counted from the middle of the spine, so that a higher scan shows the same vertebrae.
  const double from_middle = n - 0.5 * (params_.vertebrae_count - 1);
  Vertebra v;
  v.lean = from_middle * params_.bend_deg * spine_shapes::degree;
  if (params_.bend_deg == 0) {
    v.at = {0, 0, level(n)};
  } else {
    const double step = from_middle < 0 ? -1 : 1, first = params_.vertebrae_count % 2 ? 0 : 0.5 * step;
    for (double m = first; std::abs(m - from_middle) > 1e-9; m += step)  // along the chords between vertebrae
      v.at += spine_shapes::leaning({0, 0, params_.pitch_mm * step},
                                    (m + 0.5 * step) * params_.bend_deg * spine_shapes::degree);
    v.at.z += params_.pitch_mm * first;
  }
  v.is.half_width = params_.half_width_mm;
  v.is.half_height = params_.half_height_mm;
  if (params_.vertebrae_seed == 0) return v;
  std::uint64_t random = splitmix64_mixed(std::uint64_t(params_.vertebrae_seed) * splitmix64_step +
                                          std::uint64_t(std::int64_t(std::lround(2 * from_middle)) + 1000));
  const auto drawn = [&](double most) {
    return most * (2 * unit_of_bits(random = splitmix64_mixed(random + splitmix64_step)) - 1);
  };
  Shape& s = v.is;
  const double grown = 1 - 0.02 * from_middle;  // lower ones are larger
  s.half_width *= 1 + drawn(0.12);
  s.half_height *= 1 + drawn(0.08);
  s.body_x *= grown * (1 + drawn(0.03));
  s.body_y *= grown * (1 + drawn(0.03));
  s.body_z += drawn(0.8);
  s.spine_y += drawn(5), s.spine_z += drawn(2), s.spine_lean = drawn(0.12);
  for (int side = 0; side < 2; ++side) {
    s.mass[side] = 1 + drawn(0.1);
    s.transverse[side] += drawn(5);
    s.transverse_back[side] += drawn(4);
    s.transverse_up[side] += drawn(5);
  }
  for (int spur = 0; spur < 3; ++spur) {
    const double turn = drawn(120) * spine_shapes::degree, high = drawn(1);
    s.spurs.push_back({{s.body_x * std::sin(turn), -s.body_y * std::cos(turn), (high < 0 ? -1 : 1) * (s.body_z - 1)},
                       2.5 + std::abs(drawn(2))});
  }
  return v;
}

inline double Spine::skin(Vec3 world) const {
  const Vec3 p = unturned(world);
  const double back = ellipse(p.x, p.y - 10, 110, 85);
  if (p.y < 0 || std::abs(p.x) > 60) return back;
  const auto bell = [](double off, double width) { return std::exp(-off * off / (width * width)); };
  double tips = 0;
  for (const Vertebra& v : vertebrae_) tips = std::max(tips, bell(p.z - v.at.z + 4, v.is.spine_z));
  return back - bell(p.x, 16) * (16 - 6 * tips * bell(p.x, 8));
}

inline Vec3 Spine::forwards(double side) const {
  const double c = params_.converging_deg * spine_shapes::degree, r = params_.rising_deg * spine_shapes::degree;
  return {-side * std::sin(c) * std::cos(r), -std::cos(c) * std::cos(r), std::sin(r)};
}

inline Vec3 Spine::to_local(const Vertebra& v, Vec3 p) const {
  return v.lean == 0 ? p - v.at : spine_shapes::leaning(p - v.at, -v.lean);
}
inline Vec3 Spine::from_local(const Vertebra& v, Vec3 p) const {
  return v.lean == 0 ? p + v.at : spine_shapes::leaning(p, v.lean) + v.at;
}

inline Vec3 Spine::bent(int n, Vec3 world) const {
  return turned(from_local(vertebrae_[std::size_t(n)], unturned(world) - Vec3{0, 0, level(n)}));
}

inline std::vector<Spine::Pedicle> Spine::pedicles() const {
  std::vector<Pedicle> all;
  for (int n = 0; n < params_.vertebrae_count; ++n)
    for (const bool left : {true, false}) {
      const Vertebra& v = vertebrae_[std::size_t(n)];
      const Vec3 middle = pedicle_middle(v.is, left ? 1 : -1), ahead = middle + forwards(left ? 1 : -1);
      all.push_back({n, left, turned(from_local(v, middle)), turned(from_local(v, ahead) - from_local(v, middle)),
                     v.is.half_width});
    }
  return all;
}

inline void Spine::put_in_screws() {
  const SpineScrews& is = params_.screws;
  if (is.sides == SpineScrews::Sides::none) return;
  const int middle = params_.vertebrae_count / 2;
  for (const bool left : {true, false}) {
    if (is.sides == (left ? SpineScrews::Sides::right : SpineScrews::Sides::left)) continue;
    const double side = left ? 1 : -1;
    for (int n = middle; n < std::min(middle + is.levels_count, params_.vertebrae_count); ++n) {
      const Vertebra& v = vertebrae_[std::size_t(n)];
      const double axial = is.axial_deg * spine_shapes::degree, sagittal = is.sagittal_deg * spine_shapes::degree;
      Vec3 f = forwards(side);
      f = normalized(f + Vec3{side * std::tan(axial), 0, std::tan(sagittal)});
      const Vec3 through = pedicle_middle(v.is, side) + Vec3{side * is.aside_mm, 0, is.up_mm};
      double behind = 0;  // to where its axis leaves the vertebra
      for (double t = 0; t < 40; t += 0.1)
        if (vertebra(v.is, through - f * t) > 0) behind = t;
      const Vec3 seat = through - f * (behind + is.seat_mm);
      screws_.push_back({n, left, turned(from_local(v, seat + f * is.length_mm)), turned(from_local(v, seat))});
      if (is.rods && !is.needle && n > middle) {
        const Screw &below = screws_[screws_.size() - 2], &here = screws_.back();
        rods_.emplace_back(below.seat_mm - below.axis() * (0.6 * spine_shapes::head_mm),
                           here.seat_mm - here.axis() * (0.6 * spine_shapes::head_mm));
      }
    }
  }
}

inline double Spine::bone_of(int n, Vec3 world) const {
  const Vertebra& v = vertebrae_[std::size_t(n)];
  const Vec3 p = to_local(v, unturned(world));
  return std::min(vertebra(v.is, p), -canal_of(p));
}

inline double Spine::bone(Vec3 world) const {
  const Vec3 p = unturned(world);
  double best = -1e3;
  for (const Vertebra& v : vertebrae_) {
    const Vec3 local = to_local(v, p);
    if (std::abs(local.z) < params_.pitch_mm) best = std::max(best, std::min(vertebra(v.is, local), -canal_of(local)));
  }
  return best;
}

inline double Spine::canal(Vec3 world) const {
  const Vec3 p = unturned(world);
  double nearest = 1e9, canal = -1e3;
  for (const Vertebra& v : vertebrae_) {
    const Vec3 local = to_local(v, p);
    if (std::abs(local.z) < nearest) nearest = std::abs(local.z), canal = canal_of(local);
  }
  return canal;
}

inline double Spine::metal(Vec3 world) const {
  double best = -1e3;
  for (const Screw& s : screws_)
    best = std::max(
        best, spine_shapes::screw(world, s.tip_mm, s.seat_mm, 0.5 * params_.screws.diameter_mm, params_.screws.needle));
  for (const auto& [a, b] : rods_) best = std::max(best, spine_shapes::rod(world, a, b, spine_shapes::rod_radius_mm));
  return best;
}

inline double Spine::vertebra(const Shape& is, Vec3 p) const {
  if (std::abs(p.x) > 60 || p.y < -30 || p.y > 80) return -1e3;  // nothing of it is so far off
  double best = std::min(ellipse(p.x, p.y, is.body_x, is.body_y), is.body_z - std::abs(p.z));  // the body
  for (const Shape::Spur& spur : is.spurs) best = std::max(best, spur.radius - norm(p - spur.at));
  for (const int left : {1, 0}) {
    const double side = left ? 1 : -1;
    const Vec3 f = forwards(side), middle = pedicle_middle(is, side);
    const Vec3 across = normalized(cross(f, {0, 0, 1})), up = cross(across, f), d = p - middle;
    const double t = dot(d, f), wider = 0.012 * t * t;
    const double tube = ellipse(dot(d, across), dot(d, up), is.half_width + wider, is.half_height + wider);
    best = std::max(best, std::min({tube, t + 16, 16 - t}));
    const Vec3 mass = middle - f * 15;
    best = std::max(best, spine_shapes::ball(p - mass, Vec3{8, 8, 13} * is.mass[left]));
    const Vec3 end{side * is.transverse[left], is.transverse_back[left], is.transverse_up[left]};
    best = std::max(best, spine_shapes::rod(p, mass, mass + end, 4));  // transverse process
  }
  // The arch behind the canal, and the spinous process.
  const double ring = std::min(ellipse(p.x, p.y - canal_at, canal_x + 5, canal_y + 5), 9 - std::abs(p.z + 2));
  best = std::max(best, std::min(ring, p.y - canal_at));
  const double aside = is.spine_lean * std::max(0.0, p.y - canal_at - canal_y);
  best = std::max(best, std::min({3.5 - std::abs(p.x - aside), p.y - canal_at - canal_y, is.spine_y - p.y,
                                  is.spine_z - std::abs(p.z + 4)}));
  return best;
}

}  // namespace trephine::phantom
