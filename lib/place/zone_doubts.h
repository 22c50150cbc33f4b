// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "place/zones.h"

namespace trephine::place {

/// What the scan holds against a zone, as warnings; none where it holds nothing. `zone` is the zone's field (mm,
/// positive inside), `volume` may be null: then only its shape is judged.
/// - unusual_third_ventricle: below 0.5 ml, or less than 0.8 of it in one piece. An adult's has 0.5 to 3 ml; what was
///   cut from lateral ventricles or cisterns by the template is a block or shards.
/// - zone_in_air (midline, sinus, third ventricle, brainstem): 2 % and more of it are darker than -300 HU, as where the
///   template lies through nose or sinuses.
/// - fat_inside_dura: more than 2 ml, 2 mm and more inside it, are as dark as fat (-130 to -50 HU) among tissue: an
///   orbit, or the scalp above a gap of the bone.
Warnings zone_doubts(const grid::Field& zone, Zone what, const grid::HuVolume* volume);

}  // namespace trephine::place
