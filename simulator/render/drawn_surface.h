// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "render/chunks.h"
#include "render/surface_parts.h"
#include "scene/mat4.h"
#include "scene/scene.h"

namespace trephine::render {

/// What one call draws of a surface: ranges of its indices, or of its commands where the graphics card wrote these; and
/// of the indices of its coarser triangles.
class DrawList {
 public:
  struct Range {
    std::uint32_t first, count;
  };
  void clear() {
    ranges_.clear();
    coarse_.clear();
  }
  /// Ranges that follow each other become one.
  void add(std::uint32_t first, std::uint32_t count) { add_to(ranges_, first, count); }
  void add_coarse(std::uint32_t first, std::uint32_t count) { add_to(coarse_, first, count); }
  const std::vector<Range>& ranges() const { return ranges_; }
  const std::vector<Range>& coarse() const { return coarse_; }

 private:
  static void add_to(std::vector<Range>& ranges, std::uint32_t first, std::uint32_t count);
  std::vector<Range> ranges_, coarse_;
};

/// Where a surface lies, relative to the scene's centre, and its parts.
struct PlacedChunks {
  scene::Mat4 model;
  Mat3 axes;
  Vec3 offset_mm;
  bool mirrored = false;  ///< the axes are left-handed
  std::vector<Chunk> chunks;

  PlacedChunks() = default;
  PlacedChunks(const Mat3& axes_of, Vec3 offset)
      : model(scene::affine(axes_of, offset)), axes(axes_of), offset_mm(offset), mirrored(determinant(axes_of) < 0) {}
  Sight sight(const Sight& scene) const { return sight_in(scene, axes, offset_mm); }
};

/// A surface in the graphics memory, in chunks. Of the chunks that lie outside of what is looked at, and of the ranges
/// that face away, nothing is drawn.
class DrawnSurface {
 public:
  virtual ~DrawnSurface() = default;
  virtual const PlacedChunks& placed() const = 0;
  /// `seen` (by chunk; may be null): 0 where something hides the chunk.
  virtual void list(const Sight& scene, const std::vector<std::uint8_t>* seen, DrawList& out) const = 0;
  virtual void draw(const DrawList& list) const = 0;
  /// Of what coarser triangles can be made; another object where the surface was made anew, and null where the graphics
  /// card makes it.
  virtual std::shared_ptr<const SurfaceParts> parts() const { return nullptr; }
  /// Draws these where Sight::coarse says so, as soon as upload_coarse() has uploaded all of them; those before stay
  /// until then, or go at once. They are of parts(); what was cut since stays whole. None: all stays whole.
  virtual void set_coarse(std::optional<CoarseParts> /*coarse*/, bool /*keep_those_before*/) {}
  /// Uploads no more than so many bytes of them, and takes what it did from `max_bytes`. Returns whether some are
  /// left.
  virtual bool upload_coarse(std::size_t& /*max_bytes*/) { return false; }
  virtual std::size_t coarse_bytes() const { return 0; }  ///< of bytes()
  /// That the list draws. May wait for the graphics card.
  virtual std::size_t triangles(const DrawList& list) const = 0;
  virtual std::size_t bytes() const = 0;
};

}  // namespace trephine::render
