// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "mask/hu_view.h"

namespace trephine::place {

/// Throws Error 80 where much of a space that bone encloses, on the volume's lattice, is air: these are lungs, and no
/// head was scanned, or its skull is empty.
void require_no_lungs(const mask::BitMask& enclosed, const mask::HuView& hu);

}  // namespace trephine::place
