// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "grid/grid.h"

namespace trephine::voxel {

/// The haptic volume: what the hand feels. One int16 for each voxel says which shape fills it and how much of it, so
/// that one lookup serves any number of shapes [Rizzi, chapter 3]. Voxels outside of the lattice are EMPTY (`hu`: -1024
/// HU).
///
/// Encoding `occupancy`: a voxel is EMPTY (0), or one of two sums, where n is 1 to 32:
/// - 1000 n + o: shape n fills o / 255 of the voxel (o 1 to 255). The rest belongs to another shape: the one whose
///   voxels among the 26 neighbours add up to the largest occupancy (of equals the lower number), or to no shape where
///   there is none.
/// - 1000 n + 300 + o: the same, but the rest is EMPTY whatever the neighbours are. This stands where something was cut
///   away, or where air meets two shapes.
///
/// Every other value belongs to no shape. The surface of a shape lies where its occupancy is 1/2.
///
/// Encoding `hu`: the voxels are a CT's HU, and a shape is a window of them. Windows are disjoint, at most 32, and
/// begin above -1024 HU, so that no window holds what lies outside of the lattice or what was cut away. Surfaces
/// lie where the interpolated HU cross an end of a window: towards lower HU the low end of the shape's own, towards
/// higher ones the low end of the window that lies there, if no HU between the two are nobody's, else the shape's high
/// end. So windows that adjoin share a surface, and what was cut away never becomes a film of another shape. Where
/// three windows meet in one cell of eight voxels, the nearest voxel decides where it is felt.
///
/// Raw values must never be interpolated or subtracted: decode the occupancy of one shape first (voxel/decode.h).
constexpr std::int16_t haptic_empty = 0;
constexpr int haptic_base_step = 1000, haptic_bare_offset = 300, haptic_full = 255, haptic_max_shapes = 32;
constexpr int haptic_beyond_hu = -1024;  ///< encoding `hu`: what is read beyond the lattice, and written by cutting

enum class HapticEncoding { occupancy, hu };

struct HapticShape {
  std::string name;                                    ///< the anatomy's: a-z, 0-9, _
  int number = 1;                                      ///< 1 to 32, unique
  std::int16_t window_low = 1001, window_high = 1555;  ///< raw values that are its own, both ends included
};

inline constexpr char hardness_part[] = "hardness";

struct HapticVolume {
  HapticEncoding encoding = HapticEncoding::occupancy;
  grid::Grid<std::int16_t> voxels;
  std::vector<HapticShape> shapes;  ///< by ascending number
  grid::Mask hardness;  ///< empty, or on the same lattice: 0 softest to 255 hardest, of whatever shape fills the voxel

  const HapticShape* find_shape(const std::string& name) const;
};

/// A volume of the same shapes, whose voxels are a copy; without the hardness, which nothing but a drill reads.
HapticVolume copy_without_hardness(const HapticVolume& volume);

/// The windows that encoding `occupancy` gives to shape `number`.
HapticShape occupancy_shape(const std::string& name, int number);

/// Encoding `hu`, by number of shape: windows of which each begins where the one below ends have the same group, above
/// 0.
std::array<int, haptic_max_shapes + 1> adjoining_windows(const std::vector<HapticShape>& shapes);

/// Throws Error 65 naming the field unless numbers, names and windows are as said above, every voxel of encoding
/// `occupancy` is EMPTY or has a value of a declared shape, spacing is positive and finite, and hardness fits. An error
/// of the hardness is about hardness_part.
void check_haptic_volume(const HapticVolume& volume);

}  // namespace trephine::voxel
