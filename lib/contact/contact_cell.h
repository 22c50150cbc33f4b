// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// One cell between eight voxel centres. Nothing here allocates or throws.
#include <array>
#include <cstdint>

#include "contact/felt_lattice.h"

namespace trephine::contact {

/// Within a cell, trilinear functions decide the shape at a point. Along a segment they are cubics, whose roots are
/// found in Bernstein form, so that none is missed.
class ContactCell {
 public:
  /// `touch`: shapes, bit n - 1 for shape n. Where a cell that is not uniform has none of them, touched() is false, and
  /// its other functions must not be called.
  ContactCell(const FeltLattice& felt, int i, int j, int k, std::uint32_t touch = ~std::uint32_t{0});

  /// Whether the whole cell is of one shape or of none, which is `shape()`.
  bool uniform() const { return uniform_; }
  int shape() const { return shape_; }
  bool touched() const { return touched_; }

  /// The shape at p, coordinates 0 to 1.
  int shape_at(Vec3 p) const;

  /// The places on the way from p to q, 0 to 1, ascending, where the shape may change; between them it does not.
  static constexpr int max_breaks = 128;
  int breaks(Vec3 p, Vec3 q, double* out) const;

  /// The shape of the whole way from p to q; -1 where there are several, or where that is not obvious.
  int shape_along(Vec3 p, Vec3 q) const;

  /// The gradient at p from one shape (0: none) into another, for each voxel; zero where boxes decide.
  Vec3 gradient(Vec3 p, int from, int into) const;

  using Corners = std::array<double, 8>;

 private:
  void find_shapes(const FeltLattice& felt, int i, int j, int k, std::uint32_t own, std::uint32_t touch);
  void find_windows(const FeltLattice& felt);

  bool uniform_ = true, hu_ = false, touched_ = false;
  bool solid_ = false;  ///< every corner is more than half full
  bool boxes_ = false;  ///< a corner that is solid fills its eighth of the cell
  int shape_ = 0;
  std::array<std::uint32_t, 8> entry_;
  std::array<std::int16_t, 8> raw_;
  Corners filled_;  ///< occupancy: of 255, less half
  int count_ = 0;   ///< shapes near
  static constexpr int max_shapes = 8;
  std::array<int, max_shapes> number_;
  std::array<Corners, max_shapes> own_;  ///< occupancy: share of the shape; hu: HU of it and below it, less its low end
  std::array<Corners, max_shapes> top_;  ///< hu: how far HU of the shape, and above it, lie below its upper end
};

}  // namespace trephine::contact
