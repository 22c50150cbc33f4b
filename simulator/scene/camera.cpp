// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/camera.h"

#include <algorithm>
#include <cmath>

#include "base/degree.h"
#include "surface/bounds.h"
#include "touch/frames.h"

namespace trephine::scene {
namespace {

constexpr Vec3 superior{0, 0, 1}, anterior{0, -1, 0}, patient_left{1, 0, 0};
constexpr double surgeon_field_mm = 110;  // height of what the surgeon's view shows

Vec3 upright(Vec3 toward, Vec3 up) {
  Vec3 right = cross(up, toward);
  if (norm(right) < 1e-6) right = cross(anterior, toward);
  if (norm(right) < 1e-6) right = patient_left;
  return normalized(cross(toward, normalized(right)));
}

}  // namespace

Mat4 EyeView::to_camera(Vec3 origin_mm) const {
  Mat4 out;
  const Vec3 rows[3] = {right, up, toward};
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) out.at(r, c) = float(rows[r][c]);
    out.at(r, 3) = float(dot(rows[r], origin_mm - eye_mm));
  }
  return out;
}

Mat4 EyeView::projection() const {
  const double w = right_edge - left, h = top - bottom, d = far_mm - near_mm;
  Mat4 p;
  p.m.fill(0);
  p.at(0, 0) = float(2 / w);
  p.at(0, 2) = float((right_edge + left) / w);
  p.at(1, 1) = float(2 / h);
  p.at(1, 2) = float((top + bottom) / h);
  p.at(2, 2) = float(-(far_mm + near_mm) / d);
  p.at(2, 3) = float(-2 * far_mm * near_mm / d);
  p.at(3, 2) = -1;
  return p;
}

Vec3 EyeView::project(Vec3 world_mm, int width, int height) const {
  const Vec3 v = world_mm - eye_mm;
  const double z = -dot(v, toward), s = z != 0 ? 1 / z : 0;
  return {(dot(v, right) * s - left) / (right_edge - left) * width, (top - dot(v, up) * s) / (top - bottom) * height,
          z};
}

Vec3 EyeView::ray(double x, double y, int width, int height) const {
  return normalized(right * (left + x / width * (right_edge - left)) + up * (top - y / height * (top - bottom)) -
                    toward);
}

const std::vector<std::pair<std::string, ViewPreset>>& view_presets() {
  static const std::vector<std::pair<std::string, ViewPreset>> all = {
      {"surgeon", ViewPreset::surgeon}, {"front", ViewPreset::front},    {"back", ViewPreset::back},
      {"left", ViewPreset::left},       {"right", ViewPreset::right},    {"top", ViewPreset::top},
      {"bottom", ViewPreset::bottom},   {"oblique", ViewPreset::oblique}};
  return all;
}

void OrbitCamera::look(ViewPreset preset, const surface::Bounds& b, const std::optional<Vec3>& site_mm, Vec3 approach,
                       double beside) {
  if (preset == ViewPreset::surgeon && !site_mm) preset = ViewPreset::oblique;
  switch (preset) {
    case ViewPreset::front:
    case ViewPreset::back:
      toward = preset == ViewPreset::front ? anterior : -anterior;
      break;
    case ViewPreset::left:
    case ViewPreset::right:
      toward = preset == ViewPreset::left ? patient_left : -patient_left;
      break;
    case ViewPreset::top:
    case ViewPreset::bottom:
      toward = preset == ViewPreset::top ? superior : -superior;
      break;
    case ViewPreset::surgeon:
      toward = -normalized(approach);
      toward = normalized(toward - upright(toward, std::abs(toward.z) > 0.6 ? anterior : superior) * beside);
      break;
    case ViewPreset::oblique:
      toward = normalized(patient_left * 0.68 + anterior * 0.82 + superior * 0.36);
      break;
  }
  look_from(toward, b);
  if (preset != ViewPreset::surgeon) return;
  target_mm = *site_mm;
  distance_mm = 0.5 * surgeon_field_mm / std::tan(0.5 * field_of_view_deg * degree);
}

void OrbitCamera::look_from(Vec3 from, const surface::Bounds& b) {
  toward = from;
  // From above, and from below, the face is up; the surgeon stands behind a patient who lies on the back.
  up = upright(toward, std::abs(toward.z) > 0.6 ? anterior : superior);
  const double half = std::tan(0.5 * field_of_view_deg * degree);
  target_mm = (b.min_mm + b.max_mm) / 2;
  // Each corner shall lie within the frustum's height and width (of a square picture).
  distance_mm = 1;
  for (const Vec3 corner : surface::corners_of(b)) {
    const Vec3 v = corner - target_mm;
    const double across = std::max(std::abs(dot(v, up)), std::abs(dot(v, right())));
    distance_mm = std::max(distance_mm, across / half + dot(v, toward));
  }
  distance_mm *= 1.04;
}

void OrbitCamera::show(Vec3 middle_mm, double radius_mm) {
  target_mm = middle_mm;
  distance_mm = radius_mm / std::tan(0.5 * field_of_view_deg * degree);
}

void OrbitCamera::orbit(double right_rad, double up_rad) {
  // Where the view is from straight above or below, the turn is about the picture's own upward axis.
  const Vec3 pole = std::abs(dot(toward, superior)) < 0.999 && dot(up, superior) > 0 ? superior : up;
  toward = normalized(touch::turned_about(toward, pole, -right_rad));
  up = touch::turned_about(up, pole, -right_rad);
  const Vec3 side = right();
  const Vec3 next = normalized(touch::turned_about(toward, side, -up_rad));
  if (std::abs(dot(next, superior)) < 0.9995) {
    toward = next;
    up = upright(toward, dot(up, superior) < -0.2 ? -superior : superior);
  }
}

void OrbitCamera::pan(double right_ratio, double up_ratio) {
  const double height_mm = 2 * distance_mm * std::tan(0.5 * field_of_view_deg * degree);
  target_mm += (right() * right_ratio + up * up_ratio) * height_mm;
}

void OrbitCamera::zoom(double factor) { distance_mm = std::clamp(distance_mm * factor, 10.0, 5000.0); }

double OrbitCamera::mm_per_px(int height) const {
  return 2 * distance_mm * std::tan(0.5 * field_of_view_deg * degree) / std::max(1, height);
}

EyeView OrbitCamera::eye(int width, int height, const surface::Bounds& scene, double offset_mm,
                         double convergence_mm) const {
  EyeView e;
  e.toward = toward;
  e.up = up;
  e.right = right();
  e.eye_mm = eye_mm() + e.right * offset_mm;
  // The field of view is that of the picture's shorter side, so that what fits a square fits every window.
  const double half = std::tan(0.5 * field_of_view_deg * degree), least = std::max(1, std::min(width, height));
  e.top = half * std::max(1, height) / least;
  e.right_edge = half * std::max(1, width) / least;
  e.bottom = -e.top;
  e.left = -e.right_edge;
  const double shift = -offset_mm / (convergence_mm > 0 ? convergence_mm : distance_mm);
  const double aside = aside_ratio * (e.right_edge - e.left);
  e.left += shift - aside;
  e.right_edge += shift - aside;
  double nearest = 1e300, farthest = 1;
  for (const Vec3 corner : surface::corners_of(scene)) {
    const double d = -dot(corner - e.eye_mm, toward);
    nearest = std::min(nearest, d);
    farthest = std::max(farthest, d);
  }
  e.far_mm = farthest + 150;  // tools reach beyond the patient
  e.near_mm = std::max({1.0, nearest - 150, e.far_mm / 2000});
  return e;
}

}  // namespace trephine::scene
