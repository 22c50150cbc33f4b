// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "picture/render.h"

namespace trephine::picture::detail {

/// Where the picture is taken from. Camera coordinates are (right, up, towards the viewer) in mm about `target`.
struct Camera {
  Vec3 right, up, toward, target_mm;
  double distance_mm = 0;  ///< of the eye from the target; 0: orthographic
  double px_per_mm = 1;    ///< in the plane through the target
  double center_x = 0, center_y = 0;

  Vec3 to_camera(Vec3 world_mm) const {
    const Vec3 c = world_mm - target_mm;
    return {dot(c, right), dot(c, up), dot(c, toward)};
  }
  /// The factor for x and y at that depth; it is linear over a triangle on the screen.
  double magnification(double z) const { return distance_mm > 0 ? distance_mm / (distance_mm - z) : 1; }
  double z_of_magnification(double m) const { return distance_mm - distance_mm / m; }
  double screen_x(Vec3 camera) const { return center_x + camera.x * magnification(camera.z) * px_per_mm; }
  double screen_y(Vec3 camera) const { return center_y - camera.y * magnification(camera.z) * px_per_mm; }
  /// The camera position seen at that place and depth.
  Vec3 at_depth(double x, double y, double z) const {
    const double k = 1 / (magnification(z) * px_per_mm);
    return {(x - center_x) * k, (center_y - y) * k, z};
  }
};

/// A camera that shows the whole frame (or, without one, the surfaces) with a margin. Screen coordinates are those of a
/// picture of params.width x params.height.
Camera camera_for(const std::vector<SurfaceView>& surfaces, const RenderParams& params);

/// Letters and scale bar.
void draw_marks(Image& image, const Camera& camera, const RenderParams& params);

}  // namespace trephine::picture::detail
