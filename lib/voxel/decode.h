// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>

#include "base/vec3.h"
#include "voxel/haptic_volume.h"

namespace trephine::voxel {

/// Encoding `hu`: the occupancy of a voxel that lies in a window that begins at `low`, or below every window. 1/2 at
/// `low`, 0 in air, and straight between, so that the surface is where the HU cross `low`.
double hu_occupancy(double hu, int low);

/// Occupancy of one shape, 0 to 1, of a haptic volume: the values that contact, drilling and the mesher read. Only the
/// constructor allocates, locks or throws; positions that are not finite, and numbers of no shape, give 0. The decoder
/// refers to the volume, which must outlive it. Voxels may change meanwhile (drilling; they are read through relaxed
/// atomics), the lattice and the shapes may not.
///
/// Encoding `occupancy`: a voxel's occupancy is its share of 255, or its part of the rest of another shape's voxel, and
/// trilinear() interpolates these. Where two shapes meet, their occupancies add up to 1, so both surfaces are the same.
///
/// Encoding `hu`, for the window [low, high] of a shape: a voxel in the window has the occupancy
///   a(x) = clamp(1/2 + (x - low) / (2 (low + 1000)), 0, 1)
/// where x is its HU (and the slope is at least that of low + 1000 = 1). It is 1/2 at the low end and 0 at -1000 and
/// below. A voxel below every window ("air") has the same function, and so less than 1/2. Every other voxel, of another
/// window, between windows or above them, has 0. trilinear() takes the weights w of the eight voxels and gives
///   a(low + min(sum of w (x - low) over x <= high, sum of w (top - x) over x >= low))
/// where top is the low end of the next window among them above the shape's, if no HU between the two are nobody's,
/// else high + 1/2. So the surface lies where the interpolated HU cross the low end of the upper of what meets there,
/// as a contour's does, and is the same for both of two windows that adjoin.
class HapticDecoder {
 public:
  explicit HapticDecoder(const HapticVolume& volume);

  /// Number of the shape that fills most of the voxel; 0 for EMPTY, for values of no shape and beyond the lattice.
  int shape_at(int i, int j, int k) const;
  /// Occupancy of shape `number` in the voxel, including its part of another shape's voxel (haptic_volume.h).
  double occupancy(int number, int i, int j, int k) const;

  double nearest(int number, Vec3 world_mm) const;    ///< occupancy of the voxel that holds the point
  double trilinear(int number, Vec3 world_mm) const;  ///< occupancy between the eight voxel centres around the point
  /// Gradient of the trilinear occupancy by central differences over one voxel to each side, in 1/mm, world. It points
  /// into the shape, and is zero where there is none.
  Vec3 gradient(int number, Vec3 world_mm) const;

 private:
  struct Window {
    int number = 0, low = 1, high = 0, group = 0;  ///< group: adjoining_windows()
  };
  double trilinear_at(int number, Vec3 index) const;
  double trilinear_hu(const Window& window, const int* begin, const double* fraction) const;
  const Window& window_of(int number) const;

  const HapticVolume& volume_;
  std::array<Window, haptic_max_shapes> windows_{};
  std::array<Window, haptic_max_shapes + 1> by_number_{};
  int window_count_ = 0, lowest_ = 0;  ///< lowest_: the lowest low end of all windows
};

}  // namespace trephine::voxel
