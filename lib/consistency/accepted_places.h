// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Places at which two surfaces are not compared.
#include <optional>
#include <vector>

#include "mask/bits.h"

namespace trephine::consistency {

constexpr double accepted_radius_mm = 20;
constexpr std::size_t max_places_count = 16;

/// Where two surfaces are not compared.
struct NotCompared {
  std::vector<Vec3> accepted_mm;  ///< about these places a person has found them right
  /// The scanned field ends at these voxels, and every surface with it; may have no voxel at all.
  std::optional<mask::BitMask> field_edge;
  bool any() const { return !accepted_mm.empty() || field_edge; }
};

bool is_accepted(Vec3 place_mm, const NotCompared& where);

/// Takes the voxels that lie there out of the mask.
void accept(mask::BitMask& wrong, const NotCompared& where);

/// The centres of the mask's voxels, LPS mm.
std::vector<Vec3> points_of(const mask::BitMask& mask);

/// Places, to the mm, about which all of these points would be accepted, `worst` first. None where more than
/// max_places_count would be needed: then the fault has no place.
std::vector<Vec3> covering(std::vector<Vec3> points_mm, Vec3 worst);

}  // namespace trephine::consistency
