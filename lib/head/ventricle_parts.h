// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <variant>

#include "base/result.h"
#include "mask/bits.h"
#include "mask/streaks.h"
#include "place/place_head.h"

namespace trephine::head {

/// The pieces of `found` (the ventricles) that may be ventricle: those of at least 0.3 ml, and smaller ones from 0.1 ml
/// on most of which lies within 3 mm of the template's ventricles. Where `place` is not sure, all from 0.1 ml on.
mask::BitMask believable_pieces(const mask::BitMask& found, const place::HeadPlace& place);

/// What the template tells of the ventricles.
struct VentricleSides {
  double ventricle_left_ml = 0, ventricle_right_ml = 0;  ///< the lateral ones
  double third_ml = 0;
  double asymmetry_ml = 0;               ///< left less right
  std::optional<double> third_shift_mm;  ///< how far the third's middle lies to the patient's left of the head's
  template <class V>
  static void describe(V& v) {
    using P = VentricleSides;
    v.number(&P::ventricle_left_ml, "ventricle_left_ml", Range{}, "The left lateral ventricle.");
    v.number(&P::ventricle_right_ml, "ventricle_right_ml", Range{}, "The right lateral ventricle.");
    v.number(&P::third_ml, "third_ml", Range{}, "The third ventricle.");
    v.number(&P::asymmetry_ml, "asymmetry_ml", Range{}, "The left lateral ventricle less the right.");
    v.number(&P::third_shift_mm, "third_shift_mm", "How far the third ventricle lies to the left of the midline.");
  }
};
struct VentricleParts {
  std::size_t pieces_count = 0;
  std::optional<VentricleSides> sides;  ///< where the place is sure
  template <class V>
  static void describe(V& v) {
    v.integer(&VentricleParts::pieces_count, "pieces_count", Range{}, "Pieces.");
    v.all_of(&VentricleParts::sides);
  }
};

/// Measures the ventricles by their parts, each voxel belonging to the part of the template that is nearest. Warns of
/// each frontal horn, body or trigone and of the third ventricle where it is missing, and of one that holds less than a
/// quarter of its other side's.
Outcome<std::monostate, VentricleParts> measure_parts(const mask::BitMask& found, const place::HeadPlace& place);

/// Warns where a thin streak of at least 0.15 ml was cut off `ventricles`: what of it runs across them is still there.
std::optional<Warning> warn_of_stubs(const mask::BitMask& cut_off, const mask::BitMask& ventricles);

/// Warns where `ventricles` lie in or next to `slices` (of `lattice`) from which
/// streaks were taken off: what is found there may be wrong.
std::optional<Warning> warn_of_streaks(const std::vector<mask::StreakedSlice>& slices, const grid::Lattice& lattice,
                                       const mask::BitMask& ventricles);

}  // namespace trephine::head
