// SPDX-License-Identifier: GPL-3.0-or-later
#include "touch/frames.h"

#include <algorithm>
#include <cmath>

namespace trephine::touch {

Vec3 turned_about(Vec3 v, Vec3 unit, double rad) {
  const double c = std::cos(rad);
  return v * c + cross(unit, v) * std::sin(rad) + unit * (dot(unit, v) * (1 - c));
}

Mat3 frame_along(Vec3 axis) {
  Mat3 f;
  f.column[2] = normalized(axis);
  const Vec3 w = f.column[2];
  f.column[0] = normalized(cross(std::abs(w.x) < 0.7 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}, w));
  f.column[1] = cross(w, f.column[0]);
  return f;
}

Vec3 usable_across(Vec3 across, Vec3 axis) {
  return norm(cross(across, axis)) >= 0.1 && norm(across) <= 1e6 ? across : Vec3{};  // not for NaN
}

Mat3 frame_of(Vec3 axis, Vec3 across) {
  if (across == Vec3{}) return frame_along(axis);
  Mat3 f;
  f.column[2] = normalized(axis);
  f.column[0] = normalized(across - f.column[2] * dot(across, f.column[2]));
  f.column[1] = cross(f.column[2], f.column[0]);
  return f;
}

Vec3 rotation_between(const Mat3& from, const Mat3& to) {
  Vec3 sines;  // of the rotation's axis by twice its sine
  double trace = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    sines += cross(from.column[c], to.column[c]);
    trace += dot(from.column[c], to.column[c]);
  }
  const double sine = 0.5 * norm(sines), cosine = 0.5 * (trace - 1);
  if (sine > 1e-9) return sines * (0.5 * std::atan2(sine, cosine) / sine);
  if (cosine > 0) return {};
  // Half a turn: the axis is the sum of a direction and what it is turned to; the longest such sum is the safest.
  Vec3 about;
  for (std::size_t c = 0; c < 3; ++c)
    if (const Vec3 sum = from.column[c] + to.column[c]; norm(sum) > norm(about)) about = sum;
  return normalized(about) * M_PI;
}

Mat3 turned_to(const Mat3& frame, const Mat3& aim, double max_rad) {
  const Vec3 rotation = rotation_between(frame, aim);
  const double angle = norm(rotation);
  if (angle <= max_rad) return aim;
  return frame_of(turned_about(frame.column[2], rotation / angle, max_rad),
                  turned_about(frame.column[0], rotation / angle, max_rad));
}

Mat3 turned(const Mat3& frame, Vec3 axis, double max_rad) {
  const Vec3 w = frame.column[2];
  Vec3 to = normalized(axis);
  if (to == Vec3{} || to == w) return frame;
  Vec3 about = cross(w, to);
  double sine = norm(about);
  const double cosine = dot(w, to);
  if (sine < 1e-12) {
    if (cosine > 0) {
      Mat3 f = frame;
      f.column[2] = to;
      return f;
    }
    about = frame.column[0];  // the opposite way, about any direction across
    sine = 0;
  } else {
    about = about / sine;
  }
  const double angle = std::min(max_rad, std::atan2(sine, cosine));
  Mat3 f;
  f.column[2] = angle < max_rad ? to : normalized(turned_about(w, about, angle));
  const Vec3 u = turned_about(frame.column[0], about, angle);
  f.column[0] = normalized(u - f.column[2] * dot(u, f.column[2]));
  f.column[1] = cross(f.column[2], f.column[0]);
  return f;
}

}  // namespace trephine::touch
