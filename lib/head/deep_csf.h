// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "mask/bits.h"

namespace trephine::segmentation {

constexpr double ventricle_speck_ml = 0.2;  ///< pieces of ventricle smaller than this are noise

/// The ventricles in tissue as soft_tissue() gives it, within the brain's envelope (sulci filled): CSF between
/// `lower_hu` and `upper_hu` deep inside, which a seeded watershed separates from cisterns, the fourth ventricle and
/// sulci at the narrowest places. Empty where there are none. `others` gets the CSF from which the ventricles are
/// separated.
BitMask deep_csf(const Grid<float>& soft, const BitMask& envelope, double lower_hu, double upper_hu,
                 const Progress& progress, BitMask* others = nullptr);

}  // namespace trephine::segmentation
