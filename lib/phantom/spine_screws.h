// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/params.h"

namespace trephine::phantom {

/// Pedicle screws of titanium in a spine: smooth shafts with a cone at the tip and a head, and rods between heads. Or
/// needles, which have no head and lead out of the patient.
struct SpineScrews {
  enum class Sides { none, left, right, both };
  Sides sides = Sides::none;
  bool needle = false;
  int levels_count = 1;
  double diameter_mm = 6.5, length_mm = 45, seat_mm = 1, aside_mm = 0, up_mm = 0, axial_deg = 0, sagittal_deg = 0,
         metal_hu = 8000;
  bool rods = false;

  template <class V>
  static void describe(V& v) {
    using P = SpineScrews;
    v.choice(&P::sides, "screws",
             {{"none", Sides::none}, {"left", Sides::left}, {"right", Sides::right}, {"both", Sides::both}},
             "Of a spine: pedicle screws, from the middle vertebra upwards.")
        .is_later();
    v.choice(&P::needle, "screw_kind", {{"screw", false}, {"needle", true}},
             "Screws, or needles of the same diameter that go on for 80 mm where a screw's head would begin.")
        .is_later();
    v.integer(&P::levels_count, "screw_levels_count", Range{1, 3}, "In how many vertebrae.").is_later();
    v.number(&P::diameter_mm, "screw_diameter_mm", Range{3, 9}, "Of the shaft.").is_later();
    v.number(&P::length_mm, "screw_length_mm", Range{15, 70}, "From the head to the tip.").is_later();
    v.number(&P::seat_mm, "screw_seat_mm", Range{-5, 20}, "How far the head begins outside of the bone.").is_later();
    v.number(&P::aside_mm, "screw_aside_mm", Range{-12, 12},
             "How far it passes the pedicle's narrowest place to the outer side.")
        .is_later();
    v.number(&P::up_mm, "screw_up_mm", Range{-12, 12}, "And towards the head.").is_later();
    v.number(&P::axial_deg, "screw_axial_deg", Range{-30, 30},
             "How much its tip leans to the outer side against the pedicle's axis.")
        .is_later();
    v.number(&P::sagittal_deg, "screw_sagittal_deg", Range{-30, 30}, "And towards the head.").is_later();
    v.number(&P::metal_hu, "screw_hu", Range{2000, 30000}, "HU of the metal; a scan ends at 3071.").is_later();
    v.flag(&P::rods, "screw_rods", "Rods from head to head, on each side.").is_later();
  }
};

}  // namespace trephine::phantom
