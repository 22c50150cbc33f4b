// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "cases/case.h"
#include "cast/cast_table.h"
#include "voxel/haptic_volume.h"

namespace trephine::cast {

/// A haptic volume of encoding `occupancy`, as ray casters read it. A place is seen as the shape that is felt there,
/// whose trilinear occupancy (voxel/decode.h) is at least 1/2; it has the colour of its material, and an opacity for
/// all of it. Where no shape has that much, nothing is seen.
class CastShapes {
 public:
  struct Voxel {
    std::uint8_t number = 0, share = 0, rest = 0, unused = 0;  ///< as voxel::VoxelShapes
  };
  static constexpr int count = voxel::haptic_max_shapes + 1;
  using Entries = std::array<CastTable::Entry, count>;  ///< by number; 0 is clear

  /// All shapes are opaque.
  CastShapes(const voxel::HapticVolume& volume, const cases::CaseHaptic& haptic);
  const grid::Grid<Voxel>& voxels() const { return voxels_; }
  const Entries& entries() const { return entries_; }
  /// Of a layer of 1 mm.
  void set_opacity(int number, double opacity) { entries_[std::size_t(number)][3] = float(opacity); }
  /// Looks again at voxels that were changed, and at their neighbours, whose rest may now be another's. Returns all
  /// these.
  grid::Box follow(const voxel::HapticVolume& volume, const grid::Box& changed);
  /// Whether anything of the voxel is seen.
  bool sees(const Voxel& v) const {
    return (v.share > 0 && entries_[v.number][3] > 0) || (v.share < voxel::haptic_full && entries_[v.rest][3] > 0);
  }

 private:
  grid::Grid<Voxel> voxels_;
  Entries entries_{};
};

}  // namespace trephine::cast
