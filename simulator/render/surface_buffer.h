// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <vector>

#include "render/gl_object.h"
#include "scene/scene.h"
#include "scene/tool_solid.h"
#include "voxel/live_surface.h"

namespace trephine {

/// Vertices and triangles in the graphics memory, drawn by one call.
class SurfaceBuffer {
 public:
  SurfaceBuffer() = default;
  explicit SurfaceBuffer(const SceneSurface& surface);
  /// With the colours of its vertices, or in one that is set before it is drawn.
  SurfaceBuffer(const Solid& solid, bool coloured);
  void draw() const;
  std::size_t triangles() const { return std::size_t(count_) / 3; }
  std::size_t bytes() const { return bytes_; }

 private:
  GlObject array_, vertices_, indices_;
  GLsizei count_ = 0;
  std::size_t bytes_ = 0;
};

/// The bricks of a LiveSurface in two buffers, each with a place of its own, drawn by one call. A brick that is made
/// anew is written into its place, and what it no longer needs there becomes triangles without an area; if it has
/// outgrown its place it moves to the end.
class BrickBuffer {
 public:
  BrickBuffer() = default;
  /// The lattice's axes, and where its first voxel lies from the scene's centre.
  BrickBuffer(const LiveSurface& surface, const Mat3& axes, Vec3 offset_mm);
  /// Writes the bricks anew: what LiveSurface::update returned.
  void update(const LiveSurface& surface, const std::vector<std::size_t>& bricks);
  void draw() const;
  const Mat4& model() const { return model_; }
  std::size_t triangles() const { return std::size_t(index_end_) / 3; }
  std::size_t bytes() const { return vertex_room_ * sizeof(SceneVertex) + index_room_ * sizeof(std::uint32_t); }

 private:
  struct Place {
    std::uint32_t first_vertex = 0, vertex_room = 0, first_index = 0, index_room = 0;
  };
  void upload_all(const LiveSurface& surface);
  void append_indices(const BrickMesh& mesh, std::uint32_t first_vertex);
  void put(const BrickMesh& mesh, const Place& place);

  GlObject array_, vertices_, indices_;
  Mat4 model_;
  bool mirrored_ = false;
  std::vector<Place> places_;
  std::size_t vertex_end_ = 0, index_end_ = 0, vertex_room_ = 0, index_room_ = 0, wasted_ = 0;
  std::vector<SceneVertex> vertex_work_;
  std::vector<std::uint32_t> index_work_;
};

}  // namespace trephine
