// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "phantom/spine.h"

namespace trephine::phantom {

/// HU at a point of the spine's frame, edges of tissues ramped over `width_mm`: cortical bone of 1.5 mm over marrow,
/// soft tissue, air, and the canal as water.
double hu_of(const Spine& spine, Vec3 p, double width_mm);

}  // namespace trephine::phantom
