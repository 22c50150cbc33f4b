// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace trephine::shaders {

// GLSL 4.30. Positions are mm from the scene's centre until to_camera; colours are linear after the vertex shader.
extern const char* const surface_vertex;
extern const char* const surface_fragment;  ///< surfaces, tools, markers, and the walls of incisions
extern const char* const plane_vertex;
extern const char* const plane_fragment;                   ///< caps of a cut, and slices of the CT
extern const char *const box_vertex, *const box_fragment;  ///< asks whether a box is seen
extern const char* const screen_vertex;
extern const char* const openness_fragment;  ///< how much light reaches a pixel past its surroundings
extern const char* const darken_fragment;
extern const char* const present_fragment;
/// Makes the triangles of bricks: the head, then definitions (COUNT: only counts them), then the rest.
extern const char *const brick_head, *const brick_compute;

}  // namespace trephine::shaders
