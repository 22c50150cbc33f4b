// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/result.h"
#include "mask/hu_view.h"

namespace trephine::place {

/// The lattice's axis that is nearest to the patient's superior direction (LPS z), up or down.
int vertical_axis(const grid::Lattice& lattice);

/// The bone of the volume where no skull is given: hysteresis 226 / 400 HU, pieces of at least 1 ml.
mask::BitMask bone_of(const mask::HuView& hu);

struct CavityResult {
  double cranial_cavity_ml = 0;
  template <class V>
  static void describe(V& v) {
    v.number(&CavityResult::cranial_cavity_ml, "cranial_cavity_ml", Range{}, "Volume of the cranial cavity.");
  }
};

/// The cranial cavity on the volume's lattice: the space inside that is not bone. Warns where it is not of the size of
/// an adult one. Throws Error 80 where no space enclosed by bone is found.
Outcome<mask::BitMask, CavityResult> cranial_cavity(const mask::BitMask& bone, const Progress& progress);

}  // namespace trephine::place
