// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "drill/live_surface.h"
#include "render/drawn_surface.h"
#include "render/gl_object.h"
#include "scene/scene.h"
#include "scene/tool_solid.h"

namespace trephine::render {

/// A solid in the graphics memory.
class SolidBuffer {
 public:
  SolidBuffer() = default;
  /// With the colours of its vertices, or in one that is set before it is drawn.
  SolidBuffer(const scene::Solid& solid, bool coloured);
  void draw() const;

 private:
  GlObject array_, vertices_, indices_;
  GLsizei count_ = 0;
};

/// Vertices and triangles of an anatomy that the processor made.
class SurfaceBuffer : public DrawnSurface {
 public:
  explicit SurfaceBuffer(std::shared_ptr<const SurfaceParts> parts);
  /// The bricks of a live surface, along the lattice's axes; its first voxel lies at `offset_mm` from the scene's
  /// centre. A brick that is made anew leaves its chunk (its triangles there lose their area) and goes to a place
  /// behind all chunks, which it keeps.
  SurfaceBuffer(const drill::LiveSurface& surface, const Mat3& axes, Vec3 offset_mm);
  /// Writes the bricks anew: what LiveSurface::update returned.
  void update(const drill::LiveSurface& surface, const std::vector<std::size_t>& bricks);

  const PlacedChunks& placed() const override { return placed_; }
  void list(const Sight& scene, const std::vector<std::uint8_t>* seen, DrawList& out) const override;
  void draw(const DrawList& list) const override;
  std::shared_ptr<const SurfaceParts> parts() const override { return parts_; }
  void set_coarse(std::optional<CoarseParts> coarse, bool keep_those_before) override;
  bool upload_coarse(std::size_t& max_bytes) override;
  std::size_t triangles(const DrawList& list) const override;
  std::size_t bytes() const override {
    return vertex_room_ * sizeof(scene::SceneVertex) + index_room_ * sizeof(std::uint32_t) + coarse_bytes();
  }
  std::size_t coarse_bytes() const override;

 private:
  struct Place {
    std::uint32_t first_vertex = 0, vertex_room = 0, first_index = 0, index_room = 0;
  };
  /// Coarser triangles of the same vertices.
  struct Coarse {
    GlObject array, indices;
    std::vector<Chunk> chunks;  ///< empty: there are none
    std::size_t bytes = 0;
  };
  /// Those that are being uploaded.
  struct Coming {
    CoarseParts parts;
    Coarse made;
    std::size_t uploaded = 0;
  };
  void upload_bricks(const drill::LiveSurface& surface);
  void upload(std::size_t spare_vertices, std::size_t spare_indices);
  GlObject make_array(const GlObject& indices) const;
  void show_coarse(Coarse coarse);
  void leave_chunk(std::size_t brick);
  void put(const drill::BrickMesh& mesh, const Place& place);
  void draw_ranges(const GlObject& array, const std::vector<DrawList::Range>& ranges) const;

  GlObject array_, vertices_, indices_;
  std::shared_ptr<const SurfaceParts> parts_;  ///< as they were uploaded; bricks that were cut since have left them
  PlacedChunks placed_;
  Coarse coarse_;
  std::optional<Coming> coming_;
  std::vector<std::uint8_t> cut_;  ///< by chunk: bricks have left it, so its coarser triangles are wrong
  BrickPlaces bricks_;
  std::vector<Place> places_;  ///< by brick, behind the chunks; without room: it is in its chunk
  std::size_t vertex_end_ = 0, index_end_ = 0, vertex_room_ = 0, index_room_ = 0;
  std::vector<scene::SceneVertex> vertex_work_;
  std::vector<std::uint32_t> index_work_;
  mutable std::vector<GLsizei> count_work_;  ///< of draw()
  mutable std::vector<const void*> first_work_;
};

/// Of a colour's part, as the shaders take it.
float linear_of(float srgb);

}  // namespace trephine::render
