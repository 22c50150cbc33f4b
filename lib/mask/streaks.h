// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "base/progress.h"
#include "grid/grid.h"
#include "mask/bits.h"

namespace trephine::mask {

/// A slice across which straight streaks ran, and how strong they were: the RMS of the means along its lines, HU.
struct StreakedSlice {
  int slice = 0;
  double rms_hu = 0;
};

/// Takes straight parallel streaks (of a holder, fillings, the edge of a field) off the soft tissue among `known`, in
/// place, and returns the slices in which there were any, in order. A slice is streaked where the means along lines of
/// at least 40 mm in one direction differ by at least 4.5 HU RMS, and by three times as much as in the median
/// direction (in sound slices of four real heads they differ by at most 3.6 HU). What is taken off each voxel is the
/// median along its line, 40 mm to either side, of the values less those around them, so that a true structure of up to
/// a quarter of that length keeps its contrast. Other slices keep their bits. Slices are those of the third axis. The
/// same bits whatever the thread count.
std::vector<StreakedSlice> remove_streaks(grid::Grid<float>& hu, const BitMask& known, const Progress& progress = {});

}  // namespace trephine::mask
