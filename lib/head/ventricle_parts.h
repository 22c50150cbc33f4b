// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/report.h"
#include "mask/bits.h"
#include "mask/streaks.h"
#include "place/place_head.h"

namespace trephine::head {

/// The pieces of `found` (the ventricles) that may be ventricle: those of at least 0.3 ml, and smaller ones from 0.1 ml
/// on most of which lies within 3 mm of the template's ventricles. Where `place` is not sure, all from 0.1 ml on.
mask::BitMask believable_pieces(const mask::BitMask& found, const place::HeadPlace& place);

/// Measures the ventricles by their parts, each voxel belonging to the part of the template that is nearest. Adds
/// "pieces_count" and, where `place` is sure, "ventricle_left_ml" and "ventricle_right_ml" (the lateral ones),
/// "third_ml", "asymmetry_ml" (left less right) and "third_shift_mm" (how far the third's middle lies to the patient's
/// left of the head's, in mm). Warns of each frontal horn, body or trigone and of the third ventricle where it is
/// missing, and of one that holds less than a quarter of its other side's.
void report_parts(const mask::BitMask& found, const place::HeadPlace& place, Report& report);

/// Warns where a thin streak of at least 0.15 ml was cut off `ventricles`: what of it runs across them is still there.
void warn_of_stubs(const mask::BitMask& cut_off, const mask::BitMask& ventricles, Report& report);

/// Adds "streaked_slices_count", and warns where `ventricles` lie in or next to `slices` (of `lattice`) from which
/// streaks were taken off: what is found there may be wrong.
void warn_of_streaks(const std::vector<mask::StreakedSlice>& slices, const grid::Lattice& lattice,
                     const mask::BitMask& ventricles, Report& report);

}  // namespace trephine::head
