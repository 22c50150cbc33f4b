// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "grid/grid.h"
#include "picture/image.h"
#include "surface/trimesh.h"

namespace trephine::picture {

enum class SlicePlane { axial, coronal, sagittal };
/// The axis along the plane's normal: 2, 1, 0.
inline int axis_of(SlicePlane plane) { return 2 - int(plane); }

struct OverlayShape {
  const surface::TriMesh* mesh = nullptr;
  Rgb colour_rgb{1, 0, 0};
  std::string name;  ///< for the legend; not listed where empty
  const grid::Field* field =
      nullptr;  ///< instead of a mesh: the line at 0 of the field, trilinear between the pixels' corners
};

struct SliceParams {
  SlicePlane plane = SlicePlane::axial;
  double position_mm = 0;  ///< LPS coordinate along the plane's normal: z axial, y coronal, x sagittal
  double window_center_hu = 40, window_width_hu = 400;
  int longer_side_px = 800;  ///< the picture's longer side; its pixels are square
  double line_width_px = 1.6;
  double fill_opacity = 0.08;  ///< of the shapes' cross-sections; 0: lines only
  bool marks = true;           ///< orientation letters, scale bar, position, legend
  std::string note;            ///< stands with the marks, above the position
};

/// How world and picture belong together: continuous pixel coordinates, (0, 0) the upper left corner of the first
/// pixel.
struct SliceGeometry {
  int width = 0, height = 0;
  double mm_per_px = 1;
  Vec3 corner_mm, right, down;  ///< world position of (0, 0), unit directions of x and y
  Vec3 to_world_mm(double x, double y) const { return corner_mm + right * (x * mm_per_px) + down * (y * mm_per_px); }
};
SliceGeometry slice_geometry(const grid::Lattice& volume, const SliceParams& params);

/// The CT resampled in the plane (trilinear), in radiological convention: axial slices as seen from the feet and
/// coronal ones from the front, with the patient's right on the left; sagittal ones with the nose on the left. The
/// exact cuts of the meshes with the plane are drawn over it. Places outside the volume are dark blue. Where the
/// picture is too low for its marks they stand in a strip below it, and the legend stands in one on its right; neither
/// is counted by slice_geometry(). The same bytes whatever the thread count. Throws Error 65 where the plane does not
/// meet the volume, or a mesh is damaged.
Image slice_overlay(const grid::HuVolume& volume, const SliceParams& params, const std::vector<OverlayShape>& shapes);

/// The coordinates along the plane's normal that the volume reaches.
/// sense.
std::array<double, 2> slice_range_mm(const grid::Lattice& volume, SlicePlane plane);

}  // namespace trephine::picture
