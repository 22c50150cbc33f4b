// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What the raw values of a haptic volume mean where it is felt. Nothing here but the constructor allocates or throws.
#include <array>
#include <cstdint>
#include <vector>

#include "voxel/haptic_volume.h"

namespace trephine::contact {

/// What an entry of VoxelTable says of a raw value.
constexpr int contact_gap = 64;    ///< HU between windows: neither a shape nor air
constexpr int contact_pure = 128;  ///< a voxel of one shape alone
inline int entry_shape(std::uint32_t entry) { return int(entry & 63); }
inline int entry_filled(std::uint32_t entry) { return int(entry >> 8 & 255); }
// Encoding `occupancy`: the shape's share of the voxel, and what it leaves to another shape nearby.
inline int entry_share(std::uint32_t entry) { return int(entry >> 16 & 255); }
inline int entry_rest(std::uint32_t entry) { return int(entry >> 24); }

/// An entry for each raw value, made once of the volume's encoding and its shapes; the voxels do not matter. An entry
/// of 0 is air, or a value that belongs to no shape.
class VoxelTable {
 public:
  explicit VoxelTable(const voxel::HapticVolume& volume);
  std::uint32_t of(std::int16_t raw) const { return entries_[std::uint16_t(raw)]; }
  /// Encoding `hu`: the ends of the shape's window.
  int low_of(int shape) const { return low_of_[std::size_t(shape)]; }
  int high_of(int shape) const { return high_of_[std::size_t(shape)]; }
  /// Where the shape ends towards higher HU that belong to `above`; 0: to nobody.
  double top_of(int shape, int above) const {
    return above != 0 && group_[std::size_t(above)] == group_[std::size_t(shape)] ? low_of(above)
                                                                                  : high_of(shape) + 0.5;
  }

 private:
  void add_windows(const std::vector<voxel::HapticShape>& shapes);
  void add_shares(const std::vector<voxel::HapticShape>& shapes);
  std::vector<std::uint32_t> entries_;
  std::array<int, voxel::haptic_max_shapes + 1> low_of_{}, high_of_{}, group_{};
};

}  // namespace trephine::contact
