// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Strands of a perforated sheet that lie on the skin without a gap.
#include "base/progress.h"
#include "mask/bits.h"
#include "mask/hu_view.h"

namespace trephine::body {

/// A radiotherapy mask, pressed onto the skin, has the skin's HU and no gap under it. What gives it away are its holes:
/// outside of the body with its relief smoothed off (opened by a ball of 5 mm) there is a thin sheet whose holes, in
/// cells of 20 mm, make up a good part of it. Ears and holders have a dozen such cells and little of such a sheet; a
/// sheet without holes has no such cells.
struct PressedStrands {
  double sheet_ml = 0;    ///< of thin sheets
  int cells_count = 0;    ///< with a perforated sheet beside the body
  bool found = false;     ///< there are so many of them that it is a mask
  mask::BitMask strands;  ///< voxels of `body` to be taken off; none unless found
};

/// `whole` is the body's tissue with its cavities filled, `body` the same with the skin's blurred edge. Near a mask,
/// the relief above the smoothed body goes, where it is lower than `most_mm`. What rises higher (ears, nose), what is
/// as thick as a ball of 3 mm (lips, lids, the rim of an orbit), and what lies within 2.5 mm of bone stays, so that
/// skin which streaks of metal have eaten away is not taken for strands. The same bits whatever the thread count.
PressedStrands find_pressed_strands(const mask::HuView& hu, const mask::BitMask& whole, const mask::BitMask& body,
                                    double most_mm, const Progress& progress = {});

}  // namespace trephine::body
