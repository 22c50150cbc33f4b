// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "scene/mat4.h"
#include "surface/trimesh.h"

namespace trephine::scene {

/// What one eye sees: its place, three unit axes (right-handed; `toward` points from the scene to the viewer), and the
/// frustum as tangents of its edges, which need not be symmetric. Positions in mm, LPS.
struct EyeView {
  Vec3 eye_mm{0, 0, 500}, right{1, 0, 0}, up{0, 1, 0}, toward{0, 0, 1};
  double left = -0.2, right_edge = 0.2, bottom = -0.2, top = 0.2;  ///< at the distance 1 from the eye
  double near_mm = 1, far_mm = 2000;

  /// Of positions relative to origin_mm, which keeps floats precise.
  Mat4 to_camera(Vec3 origin_mm) const;
  Mat4 projection() const;
  /// Where a point is seen, in pixels from the upper left corner of a picture of that size; z: its distance before the
  /// eye, mm, along the line of sight (not above 0: behind it).
  Vec3 project(Vec3 world_mm, int width, int height) const;
  /// Unit direction in which that pixel's place (from the upper left corner) is seen.
  Vec3 ray(double x, double y, int width, int height) const;
};

/// The place from which a preset looks.
enum class ViewPreset { surgeon, front, back, left, right, top, bottom, oblique };
const std::vector<std::pair<std::string, ViewPreset>>& view_presets();

/// A camera that turns about a target.
class OrbitCamera {
 public:
  Vec3 target_mm, toward{0, -1, 0}, up{0, 0, 1};  ///< toward: unit, from the target to the eye
  double distance_mm = 500, field_of_view_deg = 25;
  double aside_ratio = 0;  ///< by that part of the picture's width the target is seen right of its middle

  /// Shows the whole box from there. `surgeon` looks along `approach` (unit, into the patient) at the box's part around
  /// `site_mm`; without a site it is `oblique`. `beside`: tangent of the angle between its line of sight and the way,
  /// so that a tool hides less of what it does.
  void look(ViewPreset preset, const surface::Bounds& bounds, const std::optional<Vec3>& site_mm, Vec3 approach,
            double beside = 0.5);
  /// Shows the whole box from that direction (unit, from the patient to the eye).
  void look_from(Vec3 from, const surface::Bounds& bounds);
  /// Shows a ball of that radius from where it is.
  void show(Vec3 middle_mm, double radius_mm);
  /// Turns by angles to the right and upwards; the superior direction stays upright, except next to it.
  void orbit(double right_rad, double up_rad);
  /// Moves the target by parts of the picture's height.
  void pan(double right_ratio, double up_ratio);
  /// Comes nearer by that factor (below 1), or goes away.
  void zoom(double factor);

  Vec3 right() const { return normalized(cross(up, toward)); }
  Vec3 eye_mm() const { return target_mm + toward * distance_mm; }
  /// mm a pixel at the target.
  double mm_per_px(int height) const;
  /// `offset_mm` shifts the eye to the right and keeps what lies in the plane at `convergence_mm` before the eye where
  /// it is in the picture (0: the target's): the frustum is sheared, the axes stay parallel. `scene` gives near and
  /// far.
  EyeView eye(int width, int height, const surface::Bounds& scene, double offset_mm = 0,
              double convergence_mm = 0) const;
};

}  // namespace trephine::scene
