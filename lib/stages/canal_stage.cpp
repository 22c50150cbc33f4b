// SPDX-License-Identifier: GPL-3.0-or-later
#include "trunk/canal.h"

#include "stages/stage.h"

namespace trephine::stages {

StageType canal_stage() {
  StageType s;
  s.name = "canal";
  s.version = 2;
  s.typical.base_s = 0.2;
  s.typical.per_million_voxels_s = 0.057;
  s.typical.surface_million = 0.14;
  s.check.recognises = true;
  s.summary = "finds the spinal canal inside the bone of a spine";
  s.description =
      "Gives a field in mm that is positive inside the space which the arches of the vertebrae enclose, slice by "
      "slice. Where bone is missing (foramina, discs, between the arches) the wall is the smoothest one through the "
      "bone around the gap, and the report says how much of the wall is bone. The result is the canal in the bone, not "
      "the dural sac: a disc that bulges into it is not seen.";
  s.examples = {"trephine canal volume.nrrd --bone bone.nrrd --output canal.nrrd"};
  s.ports = {port("volume", DataKind::volume).help("CT volume in HU, in axial slices"),
             port("bone", DataKind::field).help("the spine's bone, filled")};
  s.output = DataKind::field;
  s.declares<trunk::CanalParams, trunk::CanalResult>();
  s.run = [](const AnyParams& params, const StageInputs& in, const Progress& progress) {
    return stage_outcome(trunk::find_canal(*in.get<grid::HuVolume>("volume"), *in.get<grid::Field>("bone"),
                                           params.as<trunk::CanalParams>(), progress));
  };
  return s;
}

}  // namespace trephine::stages
