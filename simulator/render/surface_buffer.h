// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "render/drawn_surface.h"
#include "render/gl_object.h"
#include "scene/scene.h"
#include "scene/tool_solid.h"
#include "voxel/live_surface.h"

namespace trephine {

/// A solid in the graphics memory.
class SolidBuffer {
 public:
  SolidBuffer() = default;
  /// With the colours of its vertices, or in one that is set before it is drawn.
  SolidBuffer(const Solid& solid, bool coloured);
  void draw() const;

 private:
  GlObject array_, vertices_, indices_;
  GLsizei count_ = 0;
};

/// Vertices and triangles of an anatomy that the processor made.
class SurfaceBuffer : public DrawnSurface {
 public:
  explicit SurfaceBuffer(const SceneSurface& surface);
  /// The bricks of a live surface, along the lattice's axes; its first voxel lies at `offset_mm` from the scene's
  /// centre. A brick that is made anew leaves its chunk (its triangles there lose their area) and goes to a place
  /// behind all chunks, which it keeps.
  SurfaceBuffer(const LiveSurface& surface, const Mat3& axes, Vec3 offset_mm);
  /// Writes the bricks anew: what LiveSurface::update returned.
  void update(const LiveSurface& surface, const std::vector<std::size_t>& bricks);

  const PlacedChunks& placed() const override { return placed_; }
  void list(const Sight& scene, const std::vector<std::uint8_t>* seen, DrawList& out) const override;
  void draw(const DrawList& list) const override;
  /// Of what the processor made from a file.
  std::optional<CoarseFacts> make_coarse(double within_mm, std::size_t most_bytes) override;
  /// Of bricks.
  std::optional<CoarseFacts> make_coarse(const LiveSurface& surface, double within_mm, std::size_t most_bytes);
  std::size_t triangles(const DrawList& list) const override;
  std::size_t bytes() const override {
    return vertex_room_ * sizeof(SceneVertex) + index_room_ * sizeof(std::uint32_t);
  }

 private:
  struct Place {
    std::uint32_t first_vertex = 0, vertex_room = 0, first_index = 0, index_room = 0;
  };
  void upload_bricks(const LiveSurface& surface);
  void keep_boxes();
  void add_coarse();
  void upload(std::size_t spare_vertices, std::size_t spare_indices);
  void leave_chunk(std::size_t brick);
  void put(const BrickMesh& mesh, const Place& place);
  void append(const BrickMesh& mesh, std::uint32_t first_vertex);

  GlObject array_, vertices_, indices_;
  PlacedChunks placed_;
  double coarse_mm_ = 0;
  std::size_t coarse_most_ = 0;  ///< bytes of them
  std::optional<CoarseFacts> coarse_facts_;
  std::vector<Chunk> coarse_;                 ///< by chunk; empty: there are no coarser triangles
  std::vector<std::pair<Vec3, Vec3>> boxes_;  ///< by chunk, of its own triangles
  std::vector<std::uint8_t> cut_;             ///< by chunk: bricks have left it, so its coarser triangles are wrong
  std::vector<std::uint32_t> chunk_of_;       ///< by brick
  std::size_t fine_end_ = 0;                  ///< of indices; behind it lie the coarser triangles
  std::size_t chunk_end_ = 0;                 ///< of indices; behind it lie bricks that were cut
  std::vector<Place> places_;                 ///< by brick, behind the chunks; without room: it is in its chunk
  std::vector<std::uint32_t> brick_first_, where_;  ///< by brick its first triangle; by triangle its indices' place
  std::size_t vertex_end_ = 0, index_end_ = 0, vertex_room_ = 0, index_room_ = 0;
  std::vector<SceneVertex> vertex_work_;
  std::vector<std::uint32_t> index_work_;
  mutable std::vector<GLsizei> count_work_;  ///< of draw()
  mutable std::vector<const void*> first_work_;
};

/// Of a colour's part, as the shaders take it.
float linear_of(float srgb);
/// A vertex as it is drawn: its normal in steps of 1/127.
SceneVertex packed(const LiveVertex& vertex);

}  // namespace trephine
