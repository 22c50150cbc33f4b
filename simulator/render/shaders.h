// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "scene/picture.h"

namespace trephine::render::shaders {

using scene::key_light;  ///< the fragment shader gets it as KEY_LIGHT

// GLSL 4.30. Positions are mm from the scene's centre until to_camera; colours are linear after the vertex shader.
extern const char* const surface_vertex;
/// Surfaces, tools, markers, and the walls of incisions: without a version, and with KEY_LIGHT and these defined before
/// it.
extern const char* const surface_fragment;
enum SurfacePart {
  grain_part = 1,
  glow_part = 2,
  balls_part = 4,
  wall_part = 8,
  shadow_part = 16,
  theatre_part = 32,
  dust_part = 64,
  label_part = 128,  ///< writes which thing it is and how far away, in place of a colour
  all_parts = 255
};
extern const char* const plane_vertex;
extern const char* const plane_fragment;                   ///< caps of a cut, and slices of the CT
extern const char* const shadow_vertex;                    ///< the tool as the light sees it, with box_fragment
extern const char *const box_vertex, *const box_fragment;  ///< asks whether a box is seen
extern const char* const screen_vertex;
extern const char* const openness_fragment;  ///< how much light reaches a pixel past its surroundings
extern const char *const smooth_fragment, *const darken_fragment;
extern const char* const present_fragment;
/// Casts rays through a volume, and lays that over the picture: without a version, and with definitions before them.
extern const char *const cast_fragment, *const cast_over_fragment;
/// Makes the triangles of bricks: the head, then definitions (COUNT: only counts them), then the rest.
extern const char *const brick_head, *const brick_compute;

}  // namespace trephine::render::shaders
