// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Nested balls as shapes of a haptic volume, for who casts rays through them.
#include "case_samples.h"
#include "cast_phantoms.h"

namespace trephine::casting {

struct Nested {
  voxel::HapticVolume volume;
  cases::CaseHaptic haptic;
};

/// Three balls of 14, 9 and 5 mm on so many voxels a side: red, green and blue.
inline Nested nested(int voxels_a_side) {
  Nested n;
  n.volume = case_samples::haptic_of({{"skin", 14, 8}, {"bone", 9, 8}, {"core", 5, 8}}, {3, -5, 20}, voxels_a_side);
  for (const voxel::HapticShape& s : n.volume.shapes) {
    cases::CaseShape shape;
    shape.name = s.name;
    shape.number = s.number;
    shape.material.colour_rgb = {0.1, 0.1, 0.1};
    shape.material.colour_rgb[std::size_t(s.number - 1)] = 0.9;
    n.haptic.shapes.push_back(shape);
  }
  return n;
}

}  // namespace trephine::casting
