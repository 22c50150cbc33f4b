// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>

#include "base/progress.h"
#include "grid/grid.h"

namespace trephine::look {

/// Slices that show nothing of their own: each has the very values of the one before it, or a single value.
struct BlankSlices {
  int count = 0;
  double from_mm = 0, to_mm = 0;  ///< from the lowest to the highest of them, LPS z of the slices' middles
};

/// Those of the volume's third axis. Noise makes no two slices of a scan alike, so these were not measured: a program
/// lost or repeated them. Slices without anything beyond the first and the last that shows something are no part of
/// the scan. Nothing where most neighbours in a row of tissue are equal: a scan without noise, whose slices may well be
/// alike. The same result whatever the thread count. Throws Cancelled.
std::optional<BlankSlices> blank_slices(const grid::HuVolume& volume, const Progress& progress = {});

}  // namespace trephine::look
