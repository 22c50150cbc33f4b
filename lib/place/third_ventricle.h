// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What of a head's ventricles is the third one.
#include "grid/grid.h"
#include "place/place_head.h"

namespace trephine::place {

/// The template moved to the side with the third ventricle, as a mass or a bleed moves it: `fluid_mm` is the signed
/// distance to the ventricles (positive inside) about the template's third ventricle. Moved by up to 12 mm, in steps of
/// half a millimetre, to where most of the template's third ventricle is fluid; but only where that is twice as much as
/// where it lies already and as on the other side, a third of its volume or more, and for three quarters none of the
/// template's lateral ventricles. Adds "third_shift_mm" (to the patient's left: above 0) where it is moved, and a
/// warning above 5 mm.
double third_shift_mm(const grid::Field& fluid_mm, const HeadPlace& place);

/// Keeps of the fluid's distances what is narrow from side to side. The template's border alone lets the third
/// ventricle bulge into lateral ventricles that are wider than the template's.
void cut_off_lateral(grid::Field& fluid_mm, const HeadPlace& place, const Progress& progress);

}  // namespace trephine::place
