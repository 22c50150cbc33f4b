// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <vector>

#include "cast/cast_shapes.h"
#include "scene/scene.h"

namespace trephine::cast {

/// Where rays go, and what ends them.
struct CastParams {
  double step_mm = 0;  ///< between two samples of a ray; 0: half of the smallest side of a voxel
  std::optional<scene::CutPlane> cut;
  std::optional<surface::Bounds> box;  ///< nothing is seen beyond it; world, along LPS
  /// How far the nearest surface is before the eye, along the line of sight, by pixel from the upper left corner, mm;
  /// empty: there is none.
  std::vector<float> surface_mm;
  bool leave_out_empty = true;  ///< bricks that show nothing; the picture is the same
};
double step_of(const CastParams& params, const grid::Lattice& lattice);

/// What is seen, by pixel from the upper left corner.
struct CastPicture {
  int width = 0, height = 0;
  std::vector<std::array<float, 4>> rgba;  ///< linear light, multiplied by alpha
  /// How far from the eye along the ray, mm: where opacity begins, and where half of the light is held back; infinite
  /// where that is nowhere.
  std::vector<float> begins_mm, hides_mm;
};

/// The reference: casts a ray through the middle of each pixel, front to back. HU are trilinear between voxel centres,
/// and those of the outermost voxels in the half voxel beyond them. Samples lie at (n + 1/2) steps from the eye; where
/// the first one behind clear ones is not clear, the place where opacity begins is found by halving, to a 32nd of a
/// step. A layer of s mm lets (1 - opacity)^s through. Light falls as on surfaces (render/shaders.cpp), by the gradient
/// over two voxels; where it is below 50 HU/mm the light has no direction [Levoy1988], nor has it at the face of a cut,
/// a box or the volume's end, where the gradient is not that of what is seen. A ray ends where less than 1/100 of the
/// light is left. The same bytes whatever the thread count. render/cast_shader.cpp does the same in GLSL.
CastPicture cast_rays(const grid::Grid<std::int16_t>& voxels, const CastTable& table, const CastBricks& bricks,
                      const scene::EyeView& eye, int width, int height, const CastParams& params = {});
/// The same of shapes, between voxel centres as CastShapes says. Light falls by the gradient of the occupancy of the
/// shape that is seen, and has no direction where that is below 0.05 a mm.
CastPicture cast_rays(const CastShapes& shapes, const CastBricks& bricks, const scene::EyeView& eye, int width,
                      int height, const CastParams& params = {});

constexpr double least_light = 0.01;    ///< a ray ends where less is left
constexpr double unlit_hu_per_mm = 50;  ///< below that gradient the light has no direction
constexpr double shape_hu = 1000;       ///< for the light, a whole occupancy counts as so many HU
constexpr int halvings = 5;
constexpr double cut_steps = 4;  ///< behind the face of a cut, over which light comes to have a direction

}  // namespace trephine::cast
