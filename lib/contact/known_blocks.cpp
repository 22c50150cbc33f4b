// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/known_blocks.h"

#include <algorithm>

#include "base/parallel.h"
#include "voxel/raw_voxel.h"

namespace trephine::contact {
namespace {

// What several corners of a cell have in common: the shape of the first in the lowest byte, and what is so of any.
enum CornerBits : std::uint32_t { other_shape_too = 256, not_half = 512, filled = 1024, of_a_shape = 2048 };

std::uint32_t corner_of(std::uint32_t entry) {
  const std::uint32_t shape = std::uint32_t(entry_shape(entry));
  const bool half = (entry & contact_pure) || 2 * entry_share(entry) > voxel::haptic_full;
  return shape | (half ? 0 : not_half) | (2 * entry_filled(entry) > voxel::haptic_full ? filled : 0) |
         (shape != 0 ? of_a_shape : 0);
}

std::uint32_t both(std::uint32_t a, std::uint32_t b) {
  return a | (b & ~std::uint32_t{255}) | (((a ^ b) & 255) != 0 ? other_shape_too : 0);
}

}  // namespace

KnownBlocks::KnownBlocks(voxel::HapticVolume& volume, const VoxelTable& table, bool cells)
    : volume_(volume), table_(table) {
  const grid::Lattice& l = volume.voxels;
  std::size_t count = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    blocks_[a] = std::max(0, (l.size[a] - 1) >> block_bits);
    count *= std::size_t(blocks_[a]);
  }
  block_state_.assign(count, mixed_block);
  if (cells) {
    block_cells_.assign(2 * count, ~std::uint64_t{0});
    block_names_.assign(count, 0);
  }
  block_near_.assign(count, all_shapes);
  settle(grid::whole_box(l));
  if (volume.encoding == voxel::HapticEncoding::occupancy) keep_second_shapes();
}

int KnownBlocks::cell_shape(const Block& block, int i, int j, int k) const {
  constexpr int last = (1 << block_bits) - 1;
  const int cell = (i & last) + ((j & last) << block_bits) + ((k & last) << 2 * block_bits);
  const std::uint64_t cells =
      __atomic_load_n(&block_cells_[2 * block.index + std::size_t(cell >> 5)], __ATOMIC_RELAXED);
  const int kind = int(cells >> 2 * (cell & 31) & 3);
  if (kind == 0 || kind == 3) return kind == 0 ? 0 : -1;
  return __atomic_load_n(&block_names_[block.index], __ATOMIC_RELAXED) >> (kind == 1 ? 0 : 8) & 255;
}

unsigned KnownBlocks::mixed_cells(const Block& block, int j, int k) const {
  constexpr int last = (1 << block_bits) - 1;
  constexpr unsigned low_bits = 0x55;
  if (!block.details_known || block_cells_.empty()) return low_bits;
  const int cell = ((j & last) << block_bits) + ((k & last) << 2 * block_bits);
  const std::uint64_t cells =
      __atomic_load_n(&block_cells_[2 * block.index + std::size_t(cell >> 5)], __ATOMIC_RELAXED);
  const unsigned row = unsigned(cells >> 2 * (cell & 31));
  return row & row >> 1 & low_bits;
}

void KnownBlocks::settle(const grid::Box& box) {
  grid::Grid<std::int16_t>& v = volume_.voxels;
  if (box.empty()) return;
  if (volume_.encoding != voxel::HapticEncoding::occupancy) return note_blocks(box);
  // Slices run in parallel: a voxel only gets the mark `bare`, and no other voxel's answer depends on that mark.
  parallel_for(box.begin[2], box.end[2], 4, [&](std::int64_t from, std::int64_t to) {
    for (int k = int(from); k < int(to); ++k)
      for (int j = box.begin[1]; j < box.end[1]; ++j)
        for (int i = box.begin[0]; i < box.end[0]; ++i) {
          std::int16_t& voxel = v.voxels[v.index(i, j, k)];
          const std::int16_t raw = voxel::detail::load_voxel(voxel);
          if (raw == voxel::haptic_empty || (table_.of(raw) & contact_pure)) continue;
          const voxel::detail::RawVoxel r = voxel::detail::split(raw);
          if (r.number == 0 || r.bare || voxel::detail::beside_other_shape(v, r.number, i, j, k)) continue;
          std::int16_t was = raw;  // a voxel that was lowered meanwhile keeps its new value
          __atomic_compare_exchange_n(&voxel, &was, voxel::detail::join(r.number, r.share, true), false,
                                      __ATOMIC_RELAXED, __ATOMIC_RELAXED);
        }
  });
  note_blocks(box);
}

// The blocks that hold voxels of the box, or have them as the next voxels after their own.
grid::Box KnownBlocks::blocks_of(const grid::Box& box) const {
  grid::Box blocks;
  for (std::size_t a = 0; a < 3; ++a) {
    blocks.begin[a] = std::max(0, (box.begin[a] - 1) >> block_bits);
    blocks.end[a] = std::min(blocks_[a], ((box.end[a] - 1) >> block_bits) + 1);
  }
  return blocks;
}

void KnownBlocks::loosen(const grid::Box& box) {
  __atomic_fetch_add(&loosened_, 1, __ATOMIC_ACQ_REL);
  const grid::Box blocks = blocks_of(box);
  for (int k = blocks.begin[2]; k < blocks.end[2]; ++k)
    for (int j = blocks.begin[1]; j < blocks.end[1]; ++j)
      for (int i = blocks.begin[0]; i < blocks.end[0]; ++i) {
        const std::size_t at = block_at(i, j, k);
        std::uint32_t was = __atomic_load_n(&block_state_[at], __ATOMIC_RELAXED), now;
        do now = (was & ~(one_loosening - 1)) + one_loosening + mixed_block;
        while (!__atomic_compare_exchange_n(&block_state_[at], &was, now, true, __ATOMIC_ACQ_REL, __ATOMIC_RELAXED));
      }
}

// From now until end_note no walk uses the block's details. False where the block was loosened at this very moment.
bool KnownBlocks::begin_note(std::size_t block, std::uint32_t& state) {
  state = state_of_block(block);
  const std::uint32_t unknown = state & ~details_known;
  if (state != unknown &&
      !__atomic_compare_exchange_n(&block_state_[block], &state, unknown, false, __ATOMIC_ACQ_REL, __ATOMIC_RELAXED))
    return false;
  state = unknown;
  return true;
}

// Notes count only where the block was not loosened since begin_note, or they may describe voxels as they were before.
void KnownBlocks::end_note(std::size_t block, std::uint32_t state, int shape) {
  const std::uint32_t known = (state & ~(one_loosening - 1)) + details_known + std::uint32_t(shape);
  __atomic_compare_exchange_n(&block_state_[block], &state, known, false, __ATOMIC_ACQ_REL, __ATOMIC_RELAXED);
}

// Which cells of a block are of one shape or none, as ContactCell says.
void KnownBlocks::note_cells(std::size_t block, int bi, int bj, int bk) {
  constexpr int side = 1 << block_bits, corners = side + 1;
  // A corner's two neighbours along x, four in the plane and all eight, each found from those before.
  std::uint32_t line[corners][corners][side], plane[corners][side][side];
  const grid::Grid<std::int16_t>& v = volume_.voxels;
  for (int z = 0; z < corners; ++z)
    for (int y = 0; y < corners; ++y) {
      const std::int16_t* row = v.voxels.data() + v.index(bi * side, bj * side + y, bk * side + z);
      std::uint32_t before = corner_of(table_.of(voxel::detail::load_voxel(row[0])));
      for (int x = 0; x < side; ++x) {
        const std::uint32_t next = corner_of(table_.of(voxel::detail::load_voxel(row[x + 1])));
        line[z][y][x] = both(before, next);
        before = next;
      }
    }
  for (int z = 0; z < corners; ++z)
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) plane[z][y][x] = both(line[z][y][x], line[z][y + 1][x]);
  std::uint16_t names = __atomic_load_n(&block_names_[block], __ATOMIC_RELAXED);
  const bool named = names != 0;
  std::uint64_t cells[2] = {0, 0};
  for (int z = 0; z < side; ++z)
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        const std::uint32_t eight = both(plane[z][y][x], plane[z + 1][y][x]);
        std::uint64_t kind = (eight & filled) && (eight & of_a_shape) ? 3 : 0;
        // A cell is also of one shape where more than half of every corner belongs to it.
        if (kind == 3 && !(eight & (other_shape_too | not_half))) {
          const int shape = int(eight & 255);
          if (!named && (names & 255) == 0) names = std::uint16_t(shape);
          if (!named && (names & 255) != shape && names >> 8 == 0) names = std::uint16_t(names | shape << 8);
          kind = (names & 255) == shape ? 1 : names >> 8 == shape ? 2 : 3;
        }
        const int cell = x + side * (y + side * z);
        cells[cell >> 5] |= kind << 2 * (cell & 31);
      }
  __atomic_store_n(&block_names_[block], names, __ATOMIC_RELAXED);
  for (std::size_t half = 0; half < 2; ++half)
    __atomic_store_n(&block_cells_[2 * block + half], cells[half], __ATOMIC_RELAXED);
}

// Which blocks, with the voxels after them, are of one shape or of none.
void KnownBlocks::note_blocks(const grid::Box& box) {
  const grid::Grid<std::int16_t>& v = volume_.voxels;
  const grid::Box blocks = blocks_of(box);
  constexpr int side = 1 << block_bits;
  parallel_for(blocks.begin[2], blocks.end[2], 1, [&](std::int64_t from, std::int64_t to) {
    for (int k = int(from); k < int(to); ++k)
      for (int j = blocks.begin[1]; j < blocks.end[1]; ++j)
        for (int i = blocks.begin[0]; i < blocks.end[0]; ++i) {
          const std::size_t at = block_at(i, j, k);
          std::uint32_t state;
          if (!begin_note(at, state)) continue;
          const std::int16_t first_raw = voxel::detail::load_voxel(v.at(i * side, j * side, k * side));
          const std::uint32_t first = table_.of(first_raw);
          bool same = entry_shape(first) == 0 ? first == 0 : (first & contact_pure) != 0;
          for (int z = k * side; z <= (k + 1) * side && same; ++z)
            for (int y = j * side; y <= (j + 1) * side && same; ++y) {
              const std::int16_t* row = v.voxels.data() + v.index(i * side, y, z);
              for (int x = 0; x <= side && same; ++x) {
                const std::int16_t raw = voxel::detail::load_voxel(row[x]);
                same = raw == first_raw || table_.of(raw) == first;
              }
            }
          if (same) {
            __atomic_store_n(&block_near_[at], all_shapes, __ATOMIC_RELAXED);
            end_note(at, state, entry_shape(first));
            continue;
          }
          if (!block_cells_.empty()) note_cells(at, i, j, k);
          const int low[3] = {i * side, j * side, k * side};
          int begin[3], end[3];
          for (int a = 0; a < 3; ++a) {
            begin[a] = std::max(0, low[a] - 1);
            end[a] = std::min(v.size[std::size_t(a)], low[a] + side + 2);
          }
          std::uint64_t near = 0;
          for (int z = begin[2]; z < end[2]; ++z)
            for (int y = begin[1]; y < end[1]; ++y) {
              const std::int16_t* row = v.voxels.data() + v.index(0, y, z);
              for (int x = begin[0]; x < end[0]; ++x)
                near |= std::uint64_t{1} << entry_shape(table_.of(voxel::detail::load_voxel(row[x])));
            }
          __atomic_store_n(&block_near_[at], std::uint32_t(near >> 1), __ATOMIC_RELAXED);
          note_second_shapes(at, i, j, k);
          end_note(at, state, mixed_block);
        }
  });
}

// Where more than two shapes are near, finds and keeps to which of them the rest of each shared voxel belongs.
void KnownBlocks::keep_second_shapes() {
  block_second_shapes_.assign(block_near_.size(), 0);
  std::uint32_t kept = 0;
  for (std::size_t at = 0; at < block_near_.size(); ++at) {
    const std::uint32_t but_one = block_near_[at] & (block_near_[at] - 1);
    if (shape_in(block_state_[at]) == mixed_block && (but_one & (but_one - 1)) != 0) block_second_shapes_[at] = ++kept;
  }
  second_shapes_.assign((std::size_t(kept) + 1) << 3 * block_bits, 0);
  parallel_for(0, blocks_[2], 1, [&](std::int64_t from, std::int64_t to) {
    for (int k = int(from); k < int(to); ++k)
      for (int j = 0; j < blocks_[1]; ++j)
        for (int i = 0; i < blocks_[0]; ++i) note_second_shapes(block_at(i, j, k), i, j, k);
  });
}

void KnownBlocks::note_second_shapes(std::size_t block, int bi, int bj, int bk) {
  if (block_second_shapes_.empty() || block_second_shapes_[block] == 0) return;
  const grid::Grid<std::int16_t>& v = volume_.voxels;
  constexpr int side = 1 << block_bits;
  std::uint8_t* second = second_shapes_.data() + (std::size_t(block_second_shapes_[block]) << 3 * block_bits);
  for (int z = 0; z < side; ++z)
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x, ++second) {
        const int i = bi * side + x, j = bj * side + y, k = bk * side + z;
        const std::uint32_t e = table_.of(voxel::detail::load_voxel(v.at(i, j, k)));
        const int shape = entry_rest(e) != 0 ? voxel::detail::other_shape(v, entry_shape(e), i, j, k) : 0;
        __atomic_store_n(second, std::uint8_t(shape), __ATOMIC_RELAXED);
      }
}

int KnownBlocks::second_of(int own, int i, int j, int k) const {
  if (const std::size_t at = block_of(i, j, k); at != no_block) {
    const std::uint32_t near = near_of_block(at);
    const std::uint32_t others = near & ~(std::uint32_t{1} << (own - 1));
    if ((others & (others - 1)) == 0) return others != 0 ? __builtin_ctz(others) + 1 : 0;
    const std::size_t kept = state_of_block(at) & details_known ? block_second_shapes_[at] : 0;
    if (kept != 0) {
      constexpr int last = (1 << block_bits) - 1;
      const int voxel = (i & last) + ((j & last) << block_bits) + ((k & last) << 2 * block_bits);
      return __atomic_load_n(&second_shapes_[(kept << 3 * block_bits) + std::size_t(voxel)], __ATOMIC_RELAXED);
    }
  }
  return voxel::detail::other_shape(volume_.voxels, own, i, j, k);
}

}  // namespace trephine::contact
