// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/params.h"

namespace trephine::phantom {

/// A central line in a chest: through the skin below the clavicle, into the subclavian vein and along it. And metal
/// electrodes on the skin, which are no line.
struct ChestLine {
  enum class Sides { none, right, left, both };
  enum class Ends { vein, lung };
  Sides sides = Sides::none;
  Ends ends = Ends::vein;
  double enters_mm = 35, steep_deg = 49, down_deg = 11, tip_mm = 8, aside_mm = 0, wide_mm = 2.3, line_hu = 1500;
  int electrodes_count = 0;

  template <class V>
  static void describe(V& v) {
    using P = ChestLine;
    v.choice(&P::sides, "line",
             {{"none", Sides::none}, {"right", Sides::right}, {"left", Sides::left}, {"both", Sides::both}},
             "Of a chest: a central line, on which side.")
        .is_later();
    v.choice(&P::ends, "line_ends", {{"vein", Ends::vein}, {"lung", Ends::lung}},
             "It goes on along the vein, or straight through it into the lung.")
        .is_later();
    v.number(&P::enters_mm, "line_enters_mm", Range{20, 60},
             "Where it meets the vein's middle: how far along it from the clavicle's medial end.")
        .is_later();
    v.number(&P::steep_deg, "line_steep_deg", Range{20, 70}, "How steep it goes in there, to the frontal plane.")
        .is_later();
    v.number(&P::down_deg, "line_down_deg", Range{-20, 60},
             "How far it leads downwards from there to the skin, in the frontal plane.")
        .is_later();
    v.number(&P::tip_mm, "line_tip_mm", Range{0, 40}, "How far before the vein's lower end its tip lies, along it.")
        .is_later();
    v.number(&P::aside_mm, "line_aside_mm", Range{0, 3}, "How far behind the vein's middle it runs.").is_later();
    v.number(&P::wide_mm, "line_wide_mm", Range{1, 4}, "Its diameter.").is_later();
    v.number(&P::line_hu, "line_hu", Range{300, 3000}, "HU of it, as if it had no lumen.").is_later();
    v.integer(&P::electrodes_count, "electrodes_count", Range{0, 4},
              "Snaps of metal on the skin, each with its streaks (`streak_hu`).")
        .is_later();
  }
};

}  // namespace trephine::phantom
