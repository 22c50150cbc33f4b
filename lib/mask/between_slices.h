// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>

#include "base/progress.h"
#include "grid/grid.h"

namespace trephine::mask {

/// Fills the slices between painted ones: what a person drew on every fifth slice becomes a shape in all of them. Two
/// neighbouring painted slices along `axis` (0, 1, 2) with empty ones between them are interpolated by the signed
/// distance to their outlines within the slice [Raya1990], after the middle of each is laid over the other's, so that a
/// shape which leans is followed. `painted` holds 0 and `value`; other bytes are kept, and nothing is written over
/// them. Painted slices stay as they are, and nothing is drawn beyond the first and the last one.
///
/// Returns the same lattice. Deterministic. Throws Error 64 for another axis, and where no empty slice lies between two
/// painted ones; Cancelled.
grid::Mask between_slices(const grid::Mask& painted, std::uint8_t value, int axis, const Progress& progress = {});

}  // namespace trephine::mask
