// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/progress.h"
#include "drill/live_surface.h"
#include "render/chunks.h"
#include "render/coarse.h"
#include "scene/scene.h"

namespace trephine::render {

/// A surface as it is drawn: its vertices, and its triangles chunk by chunk. Plain data that nobody changes once it is
/// made, so that any thread may read it.
struct SurfaceParts {
  std::vector<scene::SceneVertex> vertices;
  std::vector<std::uint32_t> indices;
  std::vector<Chunk> chunks;
  bool mirrored = false;  ///< its axes are left-handed, so its chunks know the normals as the world sees them
};
SurfaceParts parts_of(const scene::SceneSurface& surface);

/// Where the bricks of a live surface are in its parts.
struct BrickPlaces {
  std::vector<std::uint32_t> chunk_of;  ///< by brick
  std::vector<std::uint32_t> first;     ///< by brick its first triangle, and behind the last brick the end
  std::vector<std::uint32_t> where;     ///< by triangle the place of its indices
};
/// Of the bricks as they are, along the lattice's axes.
SurfaceParts parts_of(const drill::LiveSurface& surface, bool mirrored, BrickPlaces& places);
/// Appends a brick's vertices, and its triangles with so much added to their indices; in a left-handed lattice a
/// triangle that is counter-clockwise along its axes is turned, because it is clockwise in the world.
void append(const drill::BrickMesh& mesh, bool mirrored, std::uint32_t first_vertex,
            std::vector<scene::SceneVertex>& vertices, std::vector<std::uint32_t>& indices);
/// A vertex as it is drawn: its normal in steps of 1/127.
scene::SceneVertex packed(const drill::LiveVertex& vertex);

/// Coarser triangles of a surface's own vertices, in its own chunks.
struct CoarseParts {
  std::vector<std::uint32_t> indices;
  std::vector<Chunk> chunks;  ///< as the surface's; a box may reach further than the one of the whole triangles
  CoarseFacts facts;
};
/// None where they would take more bytes than that, or are too many to be worth it (is_worth_it), or none are left. In
/// this thread alone. Throws Cancelled.
std::optional<CoarseParts> coarse_parts(const SurfaceParts& whole, double within_mm, std::size_t max_bytes,
                                        const Progress& progress = {});

}  // namespace trephine::render
