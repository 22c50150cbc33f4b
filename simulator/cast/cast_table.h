// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "cases/case.h"
#include "grid/grid.h"
#include "voxel/transfer.h"

namespace trephine::cast {

class CastShapes;

/// What is seen of HU, as ray casters read it: an entry for each whole HU, linear between them.
class CastTable {
 public:
  static constexpr int low_hu = voxel::transfer_low_hu, count = voxel::transfer_high_hu - low_hu + 1;
  /// Linear red, green and blue, and the opacity of a layer of 1 mm.
  using Entry = std::array<float, 4>;

  CastTable() = default;
  /// Of resolved functions. Where several see something, what one lets through meets the next, and the colour is their
  /// mean by opacity.
  explicit CastTable(const std::vector<voxel::TransferFunction>& functions);
  const std::vector<Entry>& entries() const { return entries_; }
  Entry at(double hu) const;
  /// What lies below the first or above the second HU is clear; the first is above the second where all is.
  std::array<int, 2> seen_hu() const;
  /// Whether anything between the two HU is seen.
  bool sees(int from_hu, int to_hu) const;

 private:
  std::vector<Entry> entries_ = std::vector<Entry>(count, Entry{});
  std::vector<int> seen_below_ = std::vector<int>(count + 1, 0);  // how many entries before it are not clear
};

/// Of the shapes of a volume of encoding `hu`: the function that the case has, or else the window and the colour of the
/// material.
std::vector<voxel::TransferFunction> functions_of(const cases::CaseHaptic& haptic);

/// Which bricks of a volume show nothing, so that rays leave them out. A brick is 4 x 4 x 4 cells between voxel
/// centres.
struct CastBricks {
  static constexpr int side = 4;
  std::array<int, 3> size{0, 0, 0};
  /// 0: the brick shows something; n: it does not, nor do those less than n bricks away along each axis.
  std::vector<std::uint8_t> clear;
  /// The lowest and the highest HU of the voxels that a brick's cells read; of shapes none.
  std::vector<std::array<std::int16_t, 2>> range_hu;

  CastBricks() = default;
  CastBricks(const grid::Grid<std::int16_t>& voxels, const CastTable& table);
  explicit CastBricks(const CastShapes& shapes);
  /// Looks again at those that read the voxels of the box. What a cut makes clear costs only that; where something is
  /// shown that was clear, all the distances are made again.
  void look(const grid::Grid<std::int16_t>& voxels, const CastTable& table, const grid::Box& box);
  void look(const CastShapes& shapes, const grid::Box& box);
  /// By another table, of the same voxels: none of them is read.
  void look(const CastTable& table);
  std::size_t index(int i, int j, int k) const {
    return (std::size_t(k) * std::size_t(size[1]) + std::size_t(j)) * std::size_t(size[0]) + std::size_t(i);
  }

 private:
  void begin(const grid::Lattice& lattice);
  template <class Shows>
  void look_again(const grid::Lattice& lattice, const grid::Box& box, const Shows& shows);
  void find_distances();
};

}  // namespace trephine::cast
