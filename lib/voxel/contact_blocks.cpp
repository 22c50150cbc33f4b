// SPDX-License-Identifier: GPL-3.0-or-later
// What ContactVolume knows of the lattice in blocks, so that walks and shared voxels need not ask each voxel.
#include "base/parallel.h"
#include "voxel/contact.h"
#include "voxel/contact_cell.h"
#include "voxel/raw_voxel.h"

namespace trephine {

void ContactVolume::settle(const Box& box) {
  Grid<std::int16_t>& v = volume_.voxels;
  if (box.empty()) return;
  if (volume_.encoding != HapticEncoding::occupancy) return note_blocks(box);
  // Slices in parallel: only the rest's owner is written, and that is not what another voxel's owner depends on.
  parallel_for(box.begin[2], box.end[2], 4, [&](std::int64_t from, std::int64_t to) {
    for (int k = int(from); k < int(to); ++k)
      for (int j = box.begin[1]; j < box.end[1]; ++j)
        for (int i = box.begin[0]; i < box.end[0]; ++i) {
          std::int16_t& voxel = v.at(i, j, k);
          const std::int16_t raw = detail::load_voxel(voxel);
          if (raw == haptic_empty || (table_[std::uint16_t(raw)] & contact_pure)) continue;
          const detail::RawVoxel r = detail::split(raw);
          if (r.number == 0 || r.bare || detail::other_shape(v, r.number, i, j, k) != 0) continue;
          __atomic_store_n(&voxel, detail::join(r.number, r.share, true), __ATOMIC_RELAXED);
        }
  });
  note_blocks(box);
}

// The blocks that hold voxels of the box, or end with them.
Box ContactVolume::blocks_of(const Box& box) const {
  Box blocks;
  for (std::size_t a = 0; a < 3; ++a) {
    blocks.begin[a] = std::max(0, (box.begin[a] - 1) >> block_bits);
    blocks.end[a] = std::min(blocks_[a], ((box.end[a] - 1) >> block_bits) + 1);
  }
  return blocks;
}

void ContactVolume::loosen(const Box& box) {
  const Box blocks = blocks_of(box);
  for (int k = blocks.begin[2]; k < blocks.end[2]; ++k)
    for (int j = blocks.begin[1]; j < blocks.end[1]; ++j)
      for (int i = blocks.begin[0]; i < blocks.end[0]; ++i) {
        const std::size_t at = block_at(i, j, k);
        __atomic_store_n(&block_shape_[at], std::uint8_t(mixed_block), __ATOMIC_RELAXED);
        if (block_cells_.empty()) continue;
        for (std::size_t half = 0; half < 2; ++half)
          __atomic_store_n(&block_cells_[2 * at + half], ~std::uint64_t{0}, __ATOMIC_RELAXED);
      }
}

// Which cells of a block are of one shape or none, as ContactCell says.
void ContactVolume::note_cells(std::size_t block, int bi, int bj, int bk) {
  constexpr int side = 1 << block_bits, corners = side + 1;
  std::uint16_t e[corners * corners * corners];
  const Grid<std::int16_t>& v = volume_.voxels;
  std::uint16_t* to = e;
  for (int z = 0; z < corners; ++z)
    for (int y = 0; y < corners; ++y) {
      const std::int16_t* row = v.voxels.data() + v.index(bi * side, bj * side + y, bk * side + z);
      for (int x = 0; x < corners; ++x) *to++ = table_[std::uint16_t(detail::load_voxel(row[x]))];
    }
  std::uint16_t names = __atomic_load_n(&block_names_[block], __ATOMIC_RELAXED);
  const bool named = names != 0;
  std::uint64_t cells[2] = {0, 0};
  for (int z = 0; z < side; ++z)
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        const std::uint16_t* first = e + (z * corners + y) * corners + x;
        bool same = true, solid = false, some = false;
        for (int c = 0; c < 8; ++c) {
          const std::uint16_t entry = first[((c >> 2) * corners + (c >> 1 & 1)) * corners + (c & 1)];
          same = same && entry == *first;
          solid = solid || 2 * entry_filled(entry) > haptic_full;
          some = some || entry_shape(entry) != 0;
        }
        std::uint64_t kind = solid && some ? 3 : 0;
        if (kind == 3 && same && (*first & contact_pure)) {
          const int shape = entry_shape(*first);
          if (!named && (names & 255) == 0) names = std::uint16_t(shape);
          if (!named && (names & 255) != shape && names >> 8 == 0) names = std::uint16_t(names | shape << 8);
          kind = (names & 255) == shape ? 1 : names >> 8 == shape ? 2 : 3;
        }
        const int cell = x + side * (y + side * z);
        cells[cell >> 5] |= kind << 2 * (cell & 31);
      }
  __atomic_store_n(&block_names_[block], names, __ATOMIC_RELAXED);
  for (std::size_t half = 0; half < 2; ++half)
    __atomic_store_n(&block_cells_[2 * block + half], cells[half], __ATOMIC_RELEASE);
}

// Which blocks, with the voxels after them, are of one shape or of none.
void ContactVolume::note_blocks(const Box& box) {
  const Grid<std::int16_t>& v = volume_.voxels;
  const Box blocks = blocks_of(box);
  constexpr int side = 1 << block_bits;
  parallel_for(blocks.begin[2], blocks.end[2], 1, [&](std::int64_t from, std::int64_t to) {
    for (int k = int(from); k < int(to); ++k)
      for (int j = blocks.begin[1]; j < blocks.end[1]; ++j)
        for (int i = blocks.begin[0]; i < blocks.end[0]; ++i) {
          const std::uint16_t first = table_[std::uint16_t(detail::load_voxel(v.at(i * side, j * side, k * side)))];
          bool same = entry_shape(first) == 0 ? first == 0 : (first & contact_pure) != 0;
          for (int z = k * side; z <= (k + 1) * side && same; ++z)
            for (int y = j * side; y <= (j + 1) * side && same; ++y) {
              const std::int16_t* row = v.voxels.data() + v.index(i * side, y, z);
              for (int x = 0; x <= side; ++x) same = same && table_[std::uint16_t(detail::load_voxel(row[x]))] == first;
            }
          const std::size_t at = block_at(i, j, k);
          __atomic_store_n(&block_shape_[at], std::uint8_t(same ? entry_shape(first) : mixed_block), __ATOMIC_RELAXED);
          if (same) continue;
          if (!block_cells_.empty()) note_cells(at, i, j, k);
          if (block_pair_.empty()) continue;
          const Box around =
              grown({{i * side, j * side, k * side}, {(i + 1) * side, (j + 1) * side, (k + 1) * side}}, 1, v);
          int a = 0, b = 0;
          bool many = false;
          for (int z = around.begin[2]; z < around.end[2]; ++z)
            for (int y = around.begin[1]; y < around.end[1]; ++y)
              for (int x = around.begin[0]; x < around.end[0]; ++x) {
                const int s = entry_shape(table_[std::uint16_t(detail::load_voxel(v.at(x, y, z)))]);
                if (s == 0 || s == a || s == b) continue;
                many = many || b != 0;
                (a == 0 ? a : b) = s;
              }
          __atomic_store_n(&block_pair_[at], many ? many_shapes : std::uint16_t(a | b << 8), __ATOMIC_RELAXED);
        }
  });
}

int ContactVolume::second_of(int own, int i, int j, int k) const {
  const int bi = i >> block_bits, bj = j >> block_bits, bk = k >> block_bits;
  if (bi < blocks_[0] && bj < blocks_[1] && bk < blocks_[2]) {
    const std::uint16_t pair = __atomic_load_n(&block_pair_[block_at(bi, bj, bk)], __ATOMIC_RELAXED);
    if (pair != many_shapes) return (pair & 255) == own ? pair >> 8 : pair & 255;
  }
  return detail::other_shape(volume_.voxels, own, i, j, k);
}

}  // namespace trephine
