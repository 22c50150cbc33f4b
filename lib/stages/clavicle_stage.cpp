// SPDX-License-Identifier: GPL-3.0-or-later
#include "trunk/clavicle.h"

#include "stages/stage.h"

namespace trephine::stages {

StageType clavicle_stage() {
  StageType s;
  s.name = "clavicle";
  s.version = 3;
  s.typical.base_s = 0.05;
  s.typical.per_million_voxels_s = 0.015;
  s.typical.surface_million = 0.15;
  s.check.recognises = true;
  s.summary = "separates the clavicles from the other bones of a chest";
  s.description =
      "Gives a field that is positive inside the clavicles, or inside all other bone (part rest). A clavicle is a bone "
      "that is round in one sagittal plane after the other and lies in front of all other bone. At its joints it is "
      "cut from sternum and scapula where the bone is narrowest. The report says how large the cut areas are, and "
      "warns where a cut is larger than the bridge of a joint and where a side is missing.";
  s.examples = {"trephine clavicle volume.nrrd --bone bone.nrrd --output clavicle.nrrd"};
  s.ports = {
      port("volume", DataKind::volume).help("CT volume in HU, in axial slices"),
      port("bone", DataKind::field).help("all bone of the chest, filled"),
      port("without", DataKind::field).optional().help("with part rest: a vein so bright that it was taken for bone")};
  s.output = DataKind::field;
  s.declares<trunk::ClavicleParams, trunk::ClaviclesResult>();
  s.run = [](const AnyParams& params, const StageInputs& in, const Progress& progress) {
    grid::place_in(*in.get<grid::Field>("bone"),
                   grid::lattice_of(*in.get<grid::HuVolume>("volume")));  // refuses a field on another raster
    return stage_outcome(trunk::find_clavicles(*in.get<grid::Field>("bone"), params.as<trunk::ClavicleParams>(),
                                               progress, in.get<grid::Field>("without")));
  };
  return s;
}

}  // namespace trephine::stages
