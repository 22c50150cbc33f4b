// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "grid/grid.h"

namespace trephine::grid {

/// The volume with its directions said anew: letter n of `axes` is the side of the patient to which indices rise along
/// axis n, one each of L or R, P or A, S or I, such as LPS. The middle of the volume stays where it is. Where the axes
/// would be left-handed (an image stored as its mirror image), the voxels along the last one are turned round, so that
/// the volume is right-handed. Throws Error 64, field `axes`, for other letters.
HuVolume with_axes(HuVolume volume, const std::string& axes);

}  // namespace trephine::grid
