// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "render/chunks.h"
#include "render/coarse.h"
#include "scene/mat4.h"
#include "scene/scene.h"

namespace trephine {

/// What one call draws of a surface: ranges of its indices, or of its commands where the graphics card wrote these.
class DrawList {
 public:
  struct Range {
    std::uint32_t first, count;
  };
  void clear() { ranges_.clear(); }
  /// Ranges that follow each other become one.
  void add(std::uint32_t first, std::uint32_t count);
  const std::vector<Range>& ranges() const { return ranges_; }

 private:
  std::vector<Range> ranges_;
};

/// Where a surface lies, relative to the scene's centre, and its parts.
struct PlacedChunks {
  Mat4 model;
  Mat3 axes;
  Vec3 offset_mm;
  bool mirrored = false;  ///< the axes are left-handed
  std::vector<Chunk> chunks;

  PlacedChunks() = default;
  PlacedChunks(const Mat3& axes_of, Vec3 offset)
      : model(affine(axes_of, offset)), axes(axes_of), offset_mm(offset), mirrored(determinant(axes_of) < 0) {}
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
  /// Makes coarser triangles beside its own (render/coarse.h), or removes them (0). Returns what they are; none where
  /// it has none: they would take more bytes than that, are too many to be worth it (is_worth_it) or none, or the
  /// graphics card makes it.
  virtual std::optional<CoarseFacts> make_coarse(double /*within_mm*/, std::size_t /*most_bytes*/) { return {}; }
  /// That the list draws. May wait for the graphics card.
  virtual std::size_t triangles(const DrawList& list) const = 0;
  virtual std::size_t bytes() const = 0;
};

}  // namespace trephine
