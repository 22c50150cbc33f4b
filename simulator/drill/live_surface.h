// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "drill/bricks.h"
#include "voxel/haptic_volume.h"
#include "voxel/hu_shares.h"

namespace trephine::drill {

/// A vertex as a renderer takes it: mm along the lattice's own axes, from the centre of voxel (0, 0, 0); the world's
/// are origin_mm + direction * position. The normal points out of the shape, in the same axes.
struct LiveVertex {
  float position_mm[3], normal[3];
};
struct BrickMesh {
  std::vector<LiveVertex> vertices;
  std::vector<std::uint16_t> indices;  ///< three a triangle, counter-clockwise from outside
};

/// One shape's occupancy, 0 to `full`, as surfaces are made of it: a copy of the volume by the rule of shared voxels,
/// or by the windows of encoding `hu`, with two voxels of what lies beyond the lattice around. So all bricks are made
/// of the same values, whatever is cut meanwhile, and no crack opens between them.
class ShadowVolume {
 public:
  static constexpr int full = 65535;
  ShadowVolume(const voxel::HapticVolume& volume, int number);
  const BrickLayout& layout() const { return layout_; }
  Vec3 spacing_mm() const { return volume_.voxels.spacing_mm; }
  int number() const { return number_; }

  /// Copies what the marked bricks (DirtyBricks::take, of the same lattice) read. Returns the bricks that read a voxel
  /// whose value is another now, ascending; valid until the next call.
  const std::vector<std::size_t>& follow(const std::vector<std::size_t>& marked);
  /// Of the marked bricks of the last follow(), those that read another value: all that changed lies in their boxes.
  const std::vector<std::size_t>& copied() const { return copied_; }
  /// The voxels that a brick reads begin at 8 * its place - 2, and end with 8 * its place + 8.
  static constexpr int read_side = BrickLayout::side + 3;

  /// Voxel (-2, -2, -2) is the first.
  const std::uint16_t* data() const { return values_.data(); }
  std::size_t index(int i, int j, int k) const {
    return (std::size_t(k + 2) * size_[1] + std::size_t(j + 2)) * size_[0] + std::size_t(i + 2);
  }
  std::size_t size(int axis) const { return size_[axis]; }
  std::size_t row() const { return size_[0]; }
  std::size_t slice() const { return size_[0] * size_[1]; }

 private:
  bool copy(std::size_t brick);
  int share(const std::int16_t& voxel, int i, int j, int k) const;

  const voxel::HapticVolume& volume_;
  int number_;
  BrickLayout layout_;
  std::optional<voxel::HuShares> of_hu_;
  std::vector<std::int32_t> known_;  ///< by raw value, the share of it where the value alone says it
  std::size_t size_[3];
  std::vector<std::uint16_t> values_;
  std::vector<std::uint8_t> reads_it_;  ///< by brick: 1 where it reads a voxel that changed
  std::vector<std::size_t> stale_, copied_;
};

/// Whether the surface passes through a cell of the brick: whether it has triangles.
bool has_triangles(const ShadowVolume& shadow, std::size_t brick);

/// The triangles of one brick: where the trilinear occupancy along the edges between voxel centres is 1/2
/// [Lorensen1987], with solid corners kept apart on ambiguous faces, so that bricks fit together. Vertices on the
/// border of two bricks have the same bits in both.
void mesh_brick(const ShadowVolume& shadow, std::size_t brick, BrickMesh& out);

/// The surface of a shape that follows while the shape is cut, for the thread beside the servo. The bricks together are
/// closed, also at the lattice's border, after the constructor and after every update().
class LiveSurface {
 public:
  /// Makes the whole surface, on all threads. `volume` must outlive it.
  LiveSurface(const voxel::HapticVolume& volume, int number);

  /// Looks at the marked bricks (DirtyBricks::take, of the same lattice), and makes those anew that read a changed
  /// voxel. Returns them, ascending; valid until the next call.
  const std::vector<std::size_t>& update(const std::vector<std::size_t>& marked);
  /// Makes these bricks anew from the copy as it is.
  void make(const std::vector<std::size_t>& bricks);

  const BrickMesh& brick(std::size_t index) const { return bricks_[index]; }
  const BrickLayout& layout() const { return shadow_.layout(); }
  const ShadowVolume& shadow() const { return shadow_; }
  std::size_t triangles() const;

 private:
  ShadowVolume shadow_;
  std::vector<BrickMesh> bricks_;
};

}  // namespace trephine::drill
