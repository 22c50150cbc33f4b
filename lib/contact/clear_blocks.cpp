// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/clear_blocks.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "contact/felt_lattice.h"
#include "voxel/raw_voxel.h"

namespace trephine::contact {
namespace {

constexpr double rounding_mm = ClearBlocks::rounding_mm;

}  // namespace

ClearBlocks::ClearBlocks(const voxel::HapticVolume& volume, const VoxelTable& table, const KnownBlocks& blocks)
    : volume_(volume) {
  std::size_t all = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    count_[a] = volume.voxels.size[a] / side + 2;
    end_[int(a)] = side * count_[a];
    all *= std::size_t(count_[a]);
  }
  shape_.assign(all, 0);
  blocks_.assign(all, most);
  parallel_for(-1, count_[2] - 1, 1, [&](std::int64_t from, std::int64_t to) {
    for (int k = int(from); k < int(to); ++k)
      for (int j = -1; j < count_[1] - 1; ++j)
        for (int i = -1; i < count_[0] - 1; ++i) {
          const int shape = shape_of(table, blocks, i, j, k);
          if (shape == KnownBlocks::mixed_block)
            blocks_[at(i, j, k)] = 0;
          else
            shape_[at(i, j, k)] = std::uint8_t(shape);
        }
  });
  // Two blocks of one shape that touch share a voxel, so their shape is the same: what is far is so of either.
  // Along one axis after the other, the least of (the distance so far or the distance along the axis, the larger).
  const std::size_t step[3] = {1, std::size_t(count_[0]), std::size_t(count_[0]) * std::size_t(count_[1])};
  std::vector<std::uint8_t> line;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::size_t length = std::size_t(count_[a]);
    line.resize(length);
    for (std::size_t first = 0; first < all; ++first) {
      if (first / step[a] % length != 0) continue;
      for (std::size_t n = 0; n < length; ++n) line[n] = blocks_[first + n * step[a]];
      for (std::size_t n = 0; n < length; ++n) {
        int least = line[n];
        for (int far = 1; far < least; ++far) {
          if (n >= std::size_t(far)) least = std::min(least, std::max<int>(far, line[n - std::size_t(far)]));
          if (n + std::size_t(far) < length) least = std::min(least, std::max<int>(far, line[n + std::size_t(far)]));
        }
        blocks_[first + n * step[a]] = std::uint8_t(least);
      }
    }
  }
}

// As KnownBlocks says of a whole block; of one that the lattice ends in, or does not reach, whether it is empty.
int ClearBlocks::shape_of(const VoxelTable& table, const KnownBlocks& blocks, int bi, int bj, int bk) const {
  if (blocks.block(bi, bj, bk).shape != KnownBlocks::outer_block)
    return blocks.shape_of_block(bi * side, bj * side, bk * side);
  const bool hu = volume_.encoding == voxel::HapticEncoding::hu;
  if (hu && table.of(std::int16_t(voxel::haptic_beyond_hu)) != 0) return KnownBlocks::mixed_block;
  const grid::Grid<std::int16_t>& v = volume_.voxels;
  const int block[3] = {bi, bj, bk};
  int begin[3], end[3];
  for (int a = 0; a < 3; ++a) {
    begin[a] = std::max(0, block[a] * side);
    end[a] = std::min(v.size[std::size_t(a)], block[a] * side + side + 1);
  }
  for (int k = begin[2]; k < end[2]; ++k)
    for (int j = begin[1]; j < end[1]; ++j)
      for (int i = begin[0]; i < end[0]; ++i)
        if (table.of(voxel::detail::load_voxel(v.at(i, j, k))) != 0) return KnownBlocks::mixed_block;
  return 0;
}

void ClearBlocks::loosen(const grid::Box& box) {
  if (box.empty()) return;
  int first[3], last[3];
  for (std::size_t a = 0; a < 3; ++a) {
    first[a] = std::max(-1, (box.begin[a] - 1) >> KnownBlocks::block_bits);
    last[a] = std::min(count_[a] - 2, (box.end[a] - 1) >> KnownBlocks::block_bits);
  }
  bool any = false;
  for (int k = first[2]; k <= last[2]; ++k)
    for (int j = first[1]; j <= last[1]; ++j)
      for (int i = first[0]; i <= last[0]; ++i) any = any || __atomic_load_n(&blocks_[at(i, j, k)], __ATOMIC_RELAXED);
  if (!any) return;
  const auto beyond = [&](int a, int n) { return std::max({0, first[a] - n, n - last[a]}); };
  const auto begin = [&](int a) { return std::max(-1, first[a] - most + 1); };
  const auto end = [&](int a) { return std::min(count_[std::size_t(a)] - 1, last[a] + most); };
  for (int k = begin(2); k < end(2); ++k)
    for (int j = begin(1); j < end(1); ++j)
      for (int i = begin(0); i < end(0); ++i) {
        const auto now = std::uint8_t(std::max({beyond(0, i), beyond(1, j), beyond(2, k)}));
        std::uint8_t& block = blocks_[at(i, j, k)];
        std::uint8_t was = __atomic_load_n(&block, __ATOMIC_RELAXED);
        while (was > now && !__atomic_compare_exchange_n(&block, &was, now, true, __ATOMIC_RELAXED, __ATOMIC_RELAXED)) {
        }
      }
}

double ClearBlocks::beyond_mm(Vec3 index, int shape) const {
  if (shape != 0) return 0;
  const grid::Lattice& l = volume_.voxels;
  double off = 0;
  for (int a = 0; a < 3; ++a)
    off = std::max(off, l.spacing_mm[a] * std::max(-1 - index[a], index[a] - l.size[std::size_t(a)]));
  // What is not empty is no nearer than it is to the nearest place of the blocks.
  Vec3 nearest;
  for (int a = 0; a < 3; ++a) nearest[a] = std::clamp(index[a], double(-side), end_[a] - side - rounding_mm);
  return std::max(clear_mm(nearest, 0), off - rounding_mm);
}

// Those that are not of the shape are as near as their boxes are.
double clear_of_cells(const FeltLattice& felt, Vec3 index, int shape) {
  if (felt.boxes()) return 0;
  constexpr int bits = KnownBlocks::block_bits;
  const Vec3 side = felt.volume.voxels.spacing_mm;
  int cell[3];
  double off[3][3];  // squares, by axis and cell
  double least = 1e9;
  for (int a = 0; a < 3; ++a) {
    if (!(std::abs(index[a]) < 1 << 30)) return 0;
    const double low = std::floor(index[a]), within = index[a] - low;
    cell[a] = int(low);
    off[a][0] = within * within * side[a] * side[a];
    off[a][1] = 0;
    off[a][2] = (1 - within) * (1 - within) * side[a] * side[a];
    least = std::min(least, (1 + std::min(within, 1 - within)) * side[a]);
  }
  least *= least;
  int of[3] = {1 << 30, 0, 0};
  KnownBlocks::Block block;
  const auto look = [&](int x, int y, int z) {
    const double squared = off[0][x] + off[1][y] + off[2][z];
    if (squared >= least) return;
    const int i = cell[0] + x - 1, j = cell[1] + y - 1, k = cell[2] + z - 1;
    if (i >> bits != of[0] || j >> bits != of[1] || k >> bits != of[2]) {
      of[0] = i >> bits, of[1] = j >> bits, of[2] = k >> bits;
      block = felt.blocks.block(of[0], of[1], of[2]);
    }
    int is = block.shape;
    if (is >= KnownBlocks::mixed_block)
      is = is == KnownBlocks::mixed_block && block.details_known ? felt.blocks.cell_shape(block, i, j, k) : -1;
    if (is != shape) least = squared;
  };
  look(1, 1, 1);
  if (least == 0) return 0;
  for (int z = 0; z < 3; ++z)
    for (int y = 0; y < 3; ++y)
      for (int x = 0; x < 3; ++x) look(x, y, z);
  return std::max(0.0, std::sqrt(least) - rounding_mm);
}

}  // namespace trephine::contact
