// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What is known of a haptic volume in blocks of voxels, so that walks and shared voxels need not ask each voxel.
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "contact/voxel_table.h"
#include "grid/grid.h"

namespace trephine::contact {

/// The lattice in blocks of 4 x 4 x 4 voxels, each with the next voxels after it: of which shape a block is, which
/// shapes are near it, which of its cells are of one shape, and to which shape the rest of a shared voxel belongs.
///
/// Whatever is not known at the moment is said to be mixed, or near everything: then the voxels are asked, and the
/// answer is the same. Only the constructor allocates or throws. Any thread may ask and loosen, one at a time settles.
class KnownBlocks {
 public:
  static constexpr int block_bits = 2;
  static constexpr int mixed_block = 255;  ///< of several shapes, or not known
  static constexpr int outer_block = 256;  ///< beyond the whole blocks of the lattice
  static constexpr std::uint32_t all_shapes = ~std::uint32_t{0};

  /// One block as it was when it was asked for.
  struct Block {
    std::size_t index = 0;
    int shape = outer_block;          ///< of all its voxels, 0 for none; or one of the two above
    bool details_known = false;       ///< cell_shape() may be asked
    std::uint32_t near = all_shapes;  ///< shapes near it, bit n - 1 for shape n
    std::uint32_t loosened = 0;       ///< how often it was
  };

  /// Both must outlive the object. `cells`: it is also noted which cells of a sub-voxel surface are of one shape.
  /// Calls settle() for the whole volume.
  KnownBlocks(voxel::HapticVolume& volume, const VoxelTable& table, bool cells);
  KnownBlocks(const KnownBlocks&) = delete;
  KnownBlocks& operator=(const KnownBlocks&) = delete;

  /// As ContactVolume says.
  void loosen(const grid::Box& box);
  void settle(const grid::Box& box);
  std::uint32_t loosened() const { return __atomic_load_n(&loosened_, __ATOMIC_ACQUIRE); }

  /// The block at that place among the blocks.
  Block block(int bi, int bj, int bk) const {
    Block b;
    if (!has_block(bi, bj, bk)) return b;
    b.index = block_at(bi, bj, bk);
    const std::uint32_t state = state_of_block(b.index);
    b.shape = shape_in(state);
    b.loosened = state / one_loosening;
    b.details_known = (state & details_known) != 0;
    if (b.shape == mixed_block && b.details_known) b.near = __atomic_load_n(&block_near_[b.index], __ATOMIC_RELAXED);
    return b;
  }
  /// The shape (0: none) to which all voxels of the block that holds the voxel, and the next voxels after it, belong;
  /// else mixed_block.
  int shape_of_block(int i, int j, int k) const {
    const std::size_t block = block_of(i, j, k);
    return block != no_block ? shape_in(state_of_block(block)) : mixed_block;
  }
  /// The shapes near the block that holds the voxel: bit n - 1 for shape n.
  std::uint32_t near_block(int i, int j, int k) const {
    const std::size_t block = block_of(i, j, k);
    return block != no_block ? near_of_block(block) : all_shapes;
  }
  /// The shape (0: none) of the whole cell between eight voxel centres, for a sub-voxel surface; -1 where the cell is
  /// not of one shape. The block is the cell's, and its details must be known.
  int cell_shape(const Block& block, int i, int j, int k) const;
  /// Of the four cells from (i, j, k) on along x, which begin a row of the block: those that are not known to be of one
  /// shape, bit 2 n for the n-th. Between the corners of all others nothing changes.
  unsigned mixed_cells(const Block& block, int j, int k) const;
  /// The shape to which the rest of a partly filled voxel of shape `own` belongs, if the voxel is not bare.
  int second_of(int own, int i, int j, int k) const;

 private:
  static constexpr std::size_t no_block = ~std::size_t{0};
  std::uint32_t state_of_block(std::size_t block) const {
    return __atomic_load_n(&block_state_[block], __ATOMIC_ACQUIRE);
  }
  static int shape_in(std::uint32_t state) { return int(state & 255); }
  bool has_block(int bi, int bj, int bk) const {
    return bi >= 0 && bj >= 0 && bk >= 0 && bi < blocks_[0] && bj < blocks_[1] && bk < blocks_[2];
  }
  std::uint32_t near_of_block(std::size_t block) const {
    const bool known = (state_of_block(block) & details_known) != 0;
    return known ? __atomic_load_n(&block_near_[block], __ATOMIC_RELAXED) : all_shapes;
  }
  /// The block that holds the voxel, or no_block.
  std::size_t block_of(int i, int j, int k) const {
    const int bi = i >> block_bits, bj = j >> block_bits, bk = k >> block_bits;
    return has_block(bi, bj, bk) ? block_at(bi, bj, bk) : no_block;
  }
  std::size_t block_at(int bi, int bj, int bk) const {
    return (std::size_t(bk) * std::size_t(blocks_[1]) + std::size_t(bj)) * std::size_t(blocks_[0]) + std::size_t(bi);
  }
  bool begin_note(std::size_t block, std::uint32_t& state);
  void end_note(std::size_t block, std::uint32_t state, int shape);
  void note_cells(std::size_t block, int bi, int bj, int bk);
  void note_blocks(const grid::Box& box);
  void keep_second_shapes();
  void note_second_shapes(std::size_t block, int bi, int bj, int bk);
  grid::Box blocks_of(const grid::Box& voxels) const;

  voxel::HapticVolume& volume_;
  const VoxelTable& table_;
  std::uint32_t loosened_ = 0;
  std::array<int, 3> blocks_{0, 0, 0};  ///< whole ones, with the voxels after them
  /// The block's shape or mixed_block, details_known where the three vectors below may be used for it, and above these
  /// bits a count of how often it was loosened: what was found out of voxels before does not count after.
  static constexpr std::uint32_t details_known = 256, one_loosening = 512;
  std::vector<std::uint32_t> block_state_;
  /// For a sub-voxel surface, 2 bits for each cell, x fastest. 0: no shape; 1 and 2: the shapes in the low and the high
  /// byte of the block's names; 3: not of one shape or not known. Names are written once, before the first cell that
  /// needs them.
  std::vector<std::uint64_t> block_cells_;
  std::vector<std::uint16_t> block_names_;
  /// All shapes in the block, one voxel before it and two after it: bit n - 1 stands for shape n. No cell of the block
  /// has any other shape. Where there are two, the second shape of a voxel that they share is known without a search.
  std::vector<std::uint32_t> block_near_;
  /// Encoding `occupancy`: where the second shapes of the block's voxels are kept, x fastest; 0: they are not kept.
  std::vector<std::uint32_t> block_second_shapes_;
  std::vector<std::uint8_t> second_shapes_;
};

}  // namespace trephine::contact
