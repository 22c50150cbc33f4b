// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "mask/hu_view.h"

namespace trephine::head {

/// The lattice's axis that is nearest to the patient's superior direction (LPS z), up or down.
int vertical_axis(const grid::Lattice& lattice);

/// The bone of the volume where no skull is given: hysteresis 226 / 400 HU, pieces of at least 1 ml.
mask::BitMask bone_of(const mask::HuView& hu);

/// The cranial cavity on the volume's lattice: the space inside that is not bone. Throws Error 80 where no space
/// enclosed by bone is found.
mask::BitMask cranial_cavity(const mask::BitMask& bone, Report& report, const Progress& progress);

}  // namespace trephine::head
