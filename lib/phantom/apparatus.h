// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "phantom/model.h"

namespace trephine::phantom {

/// What lies around the head at level hard: mask, couch, head rest, clamps. Their shape, place and HU are those seen in
/// two real scans for radiotherapy.
struct ApparatusSample {
  double hu = -1000;          ///< of the apparatus alone, averaged over about the width asked for
  double clearance_mm = 1e3;  ///< to its nearest edge, a lower bound to first order
  Thing thing = Thing::none;  ///< at the point
};
ApparatusSample apparatus_at(const Model& model, Vec3 lps_mm, double width_mm);

/// Where the mask would lie if it were a sheet without thickness that is stretched over the face: the skin, bridged
/// over nose, chin and ears. Negative within.
double mask_envelope(const Model& model, Vec3 lps_mm);

}  // namespace trephine::phantom
