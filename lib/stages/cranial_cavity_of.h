// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>

#include "mask/bits.h"
#include "mask/hu_view.h"
#include "place/cranium.h"
#include "place/lungs.h"
#include "stages/stage.h"

namespace trephine::stages {

/// A cranial cavity, and what was found of it.
using CranialCavity = Outcome<mask::BitMask, place::CavityResult>;

/// The cavity of the skull at the port "skull" on the raster of the volume at "volume", found once in a run; without a
/// skull, bone is what is bright. Throws as place::cranial_cavity and
/// place::require_no_lungs do.
inline std::shared_ptr<const CranialCavity> cranial_cavity_of(const StageInputs& in, const Progress& progress) {
  return in.once<CranialCavity>("cranial cavity", {"volume", "skull"}, progress, [&] {
    const grid::HuVolume& ct = *in.get<grid::HuVolume>("volume");
    const grid::Field* skull = in.get<grid::Field>("skull");
    const mask::BitMask bone = skull ? mask::positive(*skull, grid::lattice_of(ct)) : place::bone_of(mask::HuView(ct));
    const auto found = std::make_shared<const CranialCavity>(place::cranial_cavity(bone, progress));
    place::require_no_lungs(found->value, mask::HuView(ct));
    return found;
  });
}

}  // namespace trephine::stages
