// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "contact/known_blocks.h"

namespace trephine::contact {

/// How far any change of shape is at least from a place of a haptic volume, known at once: for each block of
/// KnownBlocks, and for those around the lattice, how many blocks around it are of one shape as well. It only ever
/// becomes less: voxels that are cut or put back are no longer known. Positions are in voxel indices.
///
/// Only the constructor allocates. Any thread may ask and loosen.
class ClearBlocks {
 public:
  /// `blocks` must know the whole volume.
  ClearBlocks(const voxel::HapticVolume& volume, const VoxelTable& table, const KnownBlocks& blocks);
  /// As KnownBlocks::loosen().
  void loosen(const grid::Box& box);
  /// A distance within which everything is of that shape (0: none); 0 where that is not known.
  double clear_mm(Vec3 index, int shape) const {
    const Vec3 from{index.x + side, index.y + side, index.z + side};
    if (!(from.x >= 0 && from.y >= 0 && from.z >= 0 && from.x < end_.x && from.y < end_.y && from.z < end_.z))
      return beyond_mm(index, shape);
    const int block[3] = {int(from.x) / side, int(from.y) / side, int(from.z) / side};
    const std::size_t here = at(block[0] - 1, block[1] - 1, block[2] - 1);
    const int around = __atomic_load_n(&blocks_[here], __ATOMIC_RELAXED);
    if (around == 0 || shape_[here] != shape) return 0;
    double least = 1e9;
    for (int a = 0; a < 3; ++a) {
      const double low = from[a] - side * (block[a] - around + 1), high = side * (block[a] + around) - from[a];
      least = std::min(least, volume_.voxels.spacing_mm[a] * std::min(low, high));
    }
    return std::max(0.0, least - rounding_mm);
  }
  static constexpr double rounding_mm = 1e-6;  // far beyond rounding

 private:
  double beyond_mm(Vec3 index, int shape) const;
  static constexpr int side = 1 << KnownBlocks::block_bits, most = 8;  // blocks
  std::size_t at(int bi, int bj, int bk) const {                       // from -1 on
    return (std::size_t(bk + 1) * std::size_t(count_[1]) + std::size_t(bj + 1)) * std::size_t(count_[0]) +
           std::size_t(bi + 1);
  }
  int shape_of(const VoxelTable& table, const KnownBlocks& blocks, int bi, int bj, int bk) const;

  const voxel::HapticVolume& volume_;
  Vec3 end_;                          // of these blocks, from the first one's begin
  std::array<int, 3> count_{};        // of blocks, with those before and after the lattice
  std::vector<std::uint8_t> shape_;   // as it was at the begin
  std::vector<std::uint8_t> blocks_;  // how far the nearest block of several shapes is, 1: beside it; 0: it is one
};

struct FeltLattice;
/// A distance within which all cells around are of that shape (0: none); 0 where that is not known, and where boxes are
/// felt.
double clear_of_cells(const FeltLattice& felt, Vec3 index, int shape);

}  // namespace trephine::contact
