// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "voxel/haptic_volume.h"

namespace trephine::drill {

/// How a volume of encoding `hu` is drilled [Rizzi, 6.4 and 6.5]: the HU of a voxel fall (new = old - k w), it stays
/// its shape's until they leave the window, and then holds nothing. It never becomes another shape's on the way: what
/// is left is below every window. A cutter that covers a voxel in part leaves the HU with which the surface passes
/// through it.
class HuWindows {
 public:
  explicit HuWindows(const voxel::HapticVolume& volume);
  /// The shape in whose window a value lies; 0: none.
  int number(std::int16_t hu) const { return number_[std::uint16_t(hu)]; }
  /// What a voxel of the shape falls to where this share of it lies outside of the cutter.
  std::int16_t target(int number, double stays) const;
  /// The HU by which a voxel falls for the energy of a full one: those between the low end of the window and bone of
  /// the vault, or its whole width where that is less. So denser bone takes more.
  int full(int number) const { return windows_[std::size_t(number)].full; }
  /// By how much a voxel can still fall until its window is left, and not below the target.
  int left(int number, std::int16_t hu, std::int16_t target) const;
  /// A voxel that has fallen to `hu`, which may be below the window: what it holds then.
  std::int16_t settled(int number, int hu, std::int16_t target) const;

 private:
  struct Window {
    int low = 0, full = 1;
  };
  std::array<Window, voxel::haptic_max_shapes + 1> windows_{};
  std::vector<std::uint8_t> number_;
  int lowest_ = 0;
};

}  // namespace trephine::drill
