// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <string>

#include "base/params.h"

namespace trephine::print {

enum class Inserts { both, right, left, none };
enum class Ventricles { hollow, core, none };

/// What is printed of a case, and how thick and how loose.
struct PrintParams {
  double wall_mm = 2, gap_mm = 0.25, voxel_mm = 0.65, cut_above_mm = 12;
  Inserts inserts = Inserts::both;
  double insert_mm = 36;
  Ventricles ventricles = Ventricles::core;
  double mark_mm = 10;
  template <class V>
  static void describe(V& v) {
    using P = PrintParams;
    v.number(&P::wall_mm, "wall_mm", Range{0.9, 6},
             "print: no wall of a part is thinner; thinner bone is made so thick.");
    v.number(&P::gap_mm, "gap_mm", Range{0.1, 1}, "print: gap between two parts that fit into each other.");
    v.number(&P::voxel_mm, "voxel_mm", Range{0.25, 2},
             "print: raster on which the parts are made; at most a third of wall_mm.");
    v.number(
        &P::cut_above_mm, "cut_above_mm", Range{8, 60},
        "print: height above nasion, perpendicular to the line to the inion, at which the head is cut flat. Nothing "
        "below it is printed, and so no face.");
    v.choice(&P::inserts, "inserts",
             {{"both", Inserts::both}, {"right", Inserts::right}, {"left", Inserts::left}, {"none", Inserts::none}},
             "print: at which of Kocher's points the bone can be replaced.");
    v.number(&P::insert_mm, "insert_mm", Range{20, 60}, "print: width of such an insert, without its rim.");
    v.choice(
        &P::ventricles, "ventricles",
        {{"core", Ventricles::core}, {"hollow", Ventricles::hollow}, {"none", Ventricles::none}},
        "print: a full core, to be cast round with gel and dissolved; hollow ones with a channel to the outside, to "
        "be filled with water, where they are wide enough for their walls; or none.");
    v.number(&P::mark_mm, "mark_mm", Range{6, 20}, "print: diameter of the spheres by which a CT is laid on the case.");
  }
};

}  // namespace trephine::print
