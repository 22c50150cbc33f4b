// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Places about which a person has found two surfaces right, and so about which they are not compared.
#include <vector>

#include "mask/bits.h"

namespace trephine::consistency {

constexpr double accepted_radius_mm = 20;
constexpr std::size_t max_places_count = 16;

bool is_accepted(Vec3 place_mm, const std::vector<Vec3>& accepted_mm);

/// Takes the voxels about the accepted places out of the mask.
void accept(mask::BitMask& wrong, const std::vector<Vec3>& accepted_mm);

/// The centres of the mask's voxels, LPS mm.
std::vector<Vec3> points_of(const mask::BitMask& mask);

/// Places, to the mm, about which all of these points would be accepted, `worst` first. None where more than
/// max_places_count would be needed: then the fault has no place.
std::vector<Vec3> covering(std::vector<Vec3> points_mm, Vec3 worst);

}  // namespace trephine::consistency
