// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>

#include "base/progress.h"
#include "mask/bits.h"

namespace trephine::look {

/// What tells how a head lies, in the cells' axes.
struct HeadSigns {
  bool found = false;        ///< a cavity of the size of a head's
  int left_right_axis = -1;  ///< the axis across which the skull is most alike at both sides; -1: not clear
  /// How far the middle of the face's bone, and of the air within the head, lies from the cavity's, mm LPS.
  Vec3 bone_mm, air_mm;
  double bone_ml = 0, air_ml = 0;
  std::array<double, 3> alike{0, 0, 0};  ///< by axis: Dice of the bone with its mirror image
};

/// `bone`, and `air` within the body, are of one lattice of cells.
HeadSigns head_signs(const mask::BitMask& bone, const mask::BitMask& air, const Progress& progress);

}  // namespace trephine::look
