// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "mask/bits.h"
#include "place/place_head.h"

namespace trephine::head {

constexpr double ventricle_speck_ml = 0.2;  ///< pieces of ventricle smaller than this are noise

/// CSF wide enough for a ball of 1.2 mm, more than 15 mm under the surface of the brain's envelope, in tissue as
/// soft_tissue() gives it: what place_head() takes as `fluid`.
mask::BitMask wide_csf(const grid::Grid<float>& soft, const mask::BitMask& envelope, double lower_hu, double upper_hu,
                       const Progress& progress = {});

/// The ventricles in tissue as soft_tissue() gives it, within the brain's envelope (sulci filled): CSF between
/// `lower_hu` and `upper_hu` deep inside, which a seeded watershed separates from cisterns, the fourth ventricle and
/// sulci at the narrowest places. Empty where there are none. `others` gets the CSF from which the ventricles are
/// separated; `cut_off` the thin streaks that were cut off the ventricles because they lead far away from them.
///
/// Cores of the ventricles and of the other spaces are told apart by where they lie in the template. Where `place` is
/// not sure, boxes about the envelope's centre stand in for it, which hold for heads that lie straight to about 15
/// degrees.
mask::BitMask deep_csf(const grid::Grid<float>& soft, const mask::BitMask& envelope, const place::HeadPlace& place,
                       double lower_hu, double upper_hu, const Progress& progress, mask::BitMask* others = nullptr,
                       mask::BitMask* cut_off = nullptr);

}  // namespace trephine::head
