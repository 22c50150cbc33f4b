// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>

#include "base/progress.h"
#include "grid/grid.h"

namespace trephine::mask {

/// The head lies elsewhere from one slice to the next: the patient moved.
struct Motion {
  Vec3 by_mm;  ///< LPS, in the plane of the slices: what lies above the step against what lies below it
  Vec3 at_mm;  ///< LPS, the middle of the slice at which it is
};

/// The largest step of a head's bone between slices, where one is beyond doubt: of 1.5 mm and more, out of line with
/// how the outlines of the slices around it change, lasting over the next slices, and the slices fit much better with
/// it. Turns are not seen, nor is a motion of less; nothing is said of slices more than 3 mm apart. The same
/// result whatever the thread count. Throws Cancelled.
std::optional<Motion> find_motion(const grid::HuVolume& volume, const Progress& progress = {});

/// Whether the step lies between the two points, or within `near_mm` of one of them, of a scan on that lattice.
bool lies_between(const Motion& motion, const grid::Lattice& slices, Vec3 a_mm, Vec3 b_mm, double near_mm);

}  // namespace trephine::mask
