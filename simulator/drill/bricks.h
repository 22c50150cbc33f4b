// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <vector>

#include "grid/grid.h"

namespace trephine::drill {

/// A lattice in bricks of 8 x 8 x 8 cells, for the surface that follows while voxels are cut. Cells lie between voxel
/// centres; with the EMPTY voxels around the lattice there is one layer of cells on each side, so that a surface is
/// closed at the border: cell c of an axis lies between the voxels c - 1 and c.
struct BrickLayout {
  static constexpr int side = 8;
  std::array<int, 3> cells{0, 0, 0}, bricks{0, 0, 0};
  BrickLayout() = default;
  explicit BrickLayout(const grid::Lattice& lattice) {
    for (std::size_t a = 0; a < 3; ++a) {
      cells[a] = lattice.size[a] + 1;
      bricks[a] = (cells[a] + side - 1) / side;
    }
  }
  std::size_t count() const { return std::size_t(bricks[0]) * std::size_t(bricks[1]) * std::size_t(bricks[2]); }
  std::size_t index(int i, int j, int k) const {
    return (std::size_t(k) * std::size_t(bricks[1]) + std::size_t(j)) * std::size_t(bricks[0]) + std::size_t(i);
  }
  std::array<int, 3> place(std::size_t brick) const {
    const int x = int(brick % std::size_t(bricks[0])), rest = int(brick / std::size_t(bricks[0]));
    return {x, rest % bricks[1], rest / bricks[1]};
  }
  /// The bricks, [first, last], that read a voxel within `margin` of voxel v of an axis. A brick reads the corners of
  /// its cells, and the next voxels for normals: 8 b - 2 to 8 b + 8.
  int first_reader(int v, int margin) const { return std::max(0, (v - margin - 1) / side); }
  int last_reader(int axis, int v, int margin) const {
    return std::min(bricks[std::size_t(axis)] - 1, (v + margin + 2) / side);
  }
};

/// Which bricks changed: set by the one thread that cuts, after its stores, and taken by the one that makes triangles.
/// No lock, no allocation after the constructor. A mark that comes while marks are taken is taken the next time.
class DirtyBricks {
 public:
  explicit DirtyBricks(const grid::Lattice& lattice) : layout_(lattice), words_((layout_.count() + 63) / 64) {
    for (auto& w : words_) w.store(0, std::memory_order_relaxed);
  }
  const BrickLayout& layout() const { return layout_; }

  void mark(std::size_t brick) {
    words_[brick / 64].fetch_or(std::uint64_t{1} << (brick % 64), std::memory_order_release);
  }
  /// Marks the bricks whose triangles may change because voxel (i, j, k) was lowered: a voxel also changes what its
  /// neighbours are read as (haptic_volume.h), so those that read a voxel beside it.
  void mark_voxel(int i, int j, int k) {
    const int v[3] = {i, j, k};
    int low[3], high[3];
    for (int a = 0; a < 3; ++a) {
      low[a] = layout_.first_reader(v[a], 1);
      high[a] = layout_.last_reader(a, v[a], 1);
    }
    for (int z = low[2]; z <= high[2]; ++z)
      for (int y = low[1]; y <= high[1]; ++y)
        for (int x = low[0]; x <= high[0]; ++x) mark(layout_.index(x, y, z));
  }
  /// Appends the marked bricks, ascending, and clears their marks.
  void take(std::vector<std::size_t>& out) {
    for (std::size_t w = 0; w < words_.size(); ++w) {
      if (words_[w].load(std::memory_order_relaxed) == 0) continue;
      std::uint64_t bits = words_[w].exchange(0, std::memory_order_acquire);
      for (; bits != 0; bits &= bits - 1) out.push_back(w * 64 + std::size_t(__builtin_ctzll(bits)));
    }
  }

 private:
  BrickLayout layout_;
  std::vector<std::atomic<std::uint64_t>> words_;
};

}  // namespace trephine::drill
