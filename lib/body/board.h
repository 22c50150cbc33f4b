// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/progress.h"
#include "mask/hu_view.h"

namespace trephine::body {

/// A flat board or table top on which the patient lies, and which may touch the body.
struct Board {
  mask::BitMask voxels;  ///< on the volume's lattice; empty where there is none
  int axis = 1;          ///< the volume's axis across the board
  bool at_end = true;    ///< it lies towards that axis' last index, seen from the body
  double thickness_mm = 0, width_mm = 0;
};

/// Finds the board: what is as dense as plastic in nearly all slices of one place, has a straight face of at least
/// 100 mm, and is at most 60 mm thick. Nothing of a body is all of that. Where the body itself is in all slices too
/// (the scan ends within it), the board's ends beside the body show where it lies, and between them it lies under the
/// body likewise. Slices are those of the volume's third axis, along which the patient must lie; where a tilted gantry
/// cuts the table (LPS z) aslant, it is followed. A scan shorter than 60 mm has no board. The result is the same
/// whatever the thread count.
Board find_board(const mask::HuView& hu, const Progress& progress = {});

}  // namespace trephine::body
