// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "touch/felt_mesh.h"

namespace trephine::peers {

using touch::FeltMesh;

/// A depth picture of a mesh through a camera without perspective: by pixel, how high above the picture's middle the
/// surface that is nearest to the camera lies. It is drawn on the processor, as an OpenGL depth buffer would be.
class DepthPicture {
 public:
  DepthPicture(int pixels, double side_mm);
  /// Draws what lies within half a side around `middle`, seen from `towards` (unit); nothing higher than `above_mm`.
  void draw(const FeltMesh& mesh, Vec3 middle, Vec3 towards, double above_mm);

  bool drawn() const { return drawn_; }
  double pixel_mm() const { return side_mm_ / pixels_; }
  /// In the picture's own axes: mm along it, across it, and towards the camera.
  Vec3 to_picture(Vec3 p) const { return transpose_times(axes_, p - middle_); }
  Vec3 from_picture(Vec3 p) const { return axes_ * p + middle_; }
  /// The height between four pixels, and its slopes; far below everything where one of them shows nothing.
  double height(double x, double y, double* slope_x = nullptr, double* slope_y = nullptr) const;
  static constexpr float nothing = -1e9f;

 private:
  int pixels_;
  double side_mm_;
  bool drawn_ = false;
  Vec3 middle_;
  Mat3 axes_;
  std::vector<float> heights_;
  std::vector<std::array<float, 3>> corners_;  // of the mesh, in the picture's axes and pixels
};

}  // namespace trephine::peers
