// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <vector>

#include "base/params.h"
#include "base/vec3.h"

namespace trephine::phantom {

enum class Implants { none, burr_hole, catheter, two_catheters };

/// The head after a procedure: what was drilled and put in. Of effect at level hard only.
struct ImplantParams {
  Implants implants = Implants::none;
  bool on_left = false;
  double lateral_mm = 0, anterior_mm = 0;
  std::array<double, 3> aim_mm{0, 0, 0};
  double bend_mm = 0, hole_mm = 11, catheter_mm = 2.5, catheter_hu = 1500, air_ml = 0;
  int staples_count = 0;

  template <class V>
  static void describe(V& v) {
    using P = ImplantParams;
    v.choice(
        &P::implants, "implants",
        {{"none", Implants::none},
         {"burr_hole", Implants::burr_hole},
         {"catheter", Implants::catheter},
         {"two_catheters", Implants::two_catheters}},
        "Level hard: the head after a procedure: a burr hole; with a ventricular catheter through it, which goes on "
        "under the scalp; or one on each side.");
    v.choice(&P::on_left, "implant_side", {{"right", false}, {"left", true}}, "Side of the hole.");
    v.number(&P::lateral_mm, "implant_lateral_mm", Range{-25, 30},
             "How much farther from the midline than Kocher's point the hole lies.");
    v.number(&P::anterior_mm, "implant_anterior_mm", Range{-30, 30}, "How far in front of Kocher's point it lies.");
    v.numbers(&P::aim_mm, "implant_aim_mm", Range{-40, 40},
              "Where the catheter's tip lies: to the left, the back and up from the foramen of Monro of that side.");
    v.number(&P::bend_mm, "implant_bend_mm", Range{0, 10},
             "How far the middle of the catheter lies off the straight line from the hole to the tip.");
    v.number(&P::hole_mm, "implant_hole_mm", Range{2, 25}, "Diameter of the hole.");
    v.number(&P::catheter_mm, "implant_catheter_mm", Range{1, 5}, "Outer diameter of the catheter.");
    v.number(&P::catheter_hu, "implant_catheter_hu", Range{100, 3000},
             "HU of its wall, which is half as thick as its radius; its lumen holds CSF.");
    v.number(&P::air_ml, "implant_air_ml", Range{0, 40}, "Air under the bone in front of the hole.");
    v.integer(&P::staples_count, "implant_staples_count", Range{0, 12},
              "Staples of metal in the skin about the hole, each with its streaks.");
  }
};

/// What was put in, LPS mm, in the head's own frame.
struct ImplantTruth {
  bool on_left = false;
  Vec3 hole_mm, hole_out;  ///< the hole's middle on the outside of the bone; unit, out of the head
  double hole_diameter_mm = 0;
  bool has_catheter = false;
  std::vector<Vec3> course_mm;  ///< middle line from its end in the head to the hole
  Vec3 tip_mm;                  ///< the rounded end
  double catheter_diameter_mm = 0;
};

}  // namespace trephine::phantom
