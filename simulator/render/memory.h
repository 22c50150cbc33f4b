// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <cstdint>

#include "grid/grid.h"
#include "scene/scene.h"

namespace trephine::render {

/// What is counted of the graphics memory: vertices and triangles, textures, and the renderer's pictures. What a driver
/// keeps beside them is not known.
std::size_t bytes_of(const scene::SceneSurface& surface);
/// Of a picture with its depth, the one of several samples that it is made of, and the darkening.
std::size_t picture_bytes(int width, int height, int samples);
/// Of the picture that a screen shows.
inline std::size_t room_for_picture(int samples) { return picture_bytes(1920, 1080, samples); }
/// Every 2 x 2 x 2 voxels as one, their mean: an eighth of the bytes, at the same place.
grid::Grid<std::int16_t> halved(const grid::Grid<std::int16_t>& grid);

}  // namespace trephine::render
