// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/progress.h"
#include "grid/grid.h"
#include "mask/bits.h"

namespace trephine::head {

/// What of `cut` is dark tissue (oedema, a tumour, an old infarct) and no CSF. `cut` is what is to be taken from
/// `shape` (the brain with its sulci closed) as sulci and cisterns; `soft` are HU, levelled (tissue at 30) and
/// denoised.
///
/// CSF is darker than any such tissue, or it is a sheet, which is darker than what lies on both sides of it, however
/// much of its own HU a narrow sulcus shows. Where all within about a centimetre is dark on the whole, what lies
/// farther than a border from such CSF is tissue.
mask::BitMask dark_tissue(const mask::BitMask& cut, const mask::BitMask& shape, const grid::Grid<float>& soft,
                          const Progress& progress = {});

}  // namespace trephine::head
