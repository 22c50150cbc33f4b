// SPDX-License-Identifier: GPL-3.0-or-later
#include "segmentation/segment.h"

#include "stages/stage.h"

namespace trephine::stages {

StageType segment_stage() {
  StageType s;
  s.name = "segment";
  s.version = 13;
  s.typical.base_s = 0.05;
  s.typical.per_million_voxels_s = 0.033;
  s.typical.surface_million = 0.9;
  s.summary = "finds one anatomy in a CT volume by thresholds";
  s.description =
      "Gives a field on the volume's voxels that is positive inside the anatomy. Its zero crossing is the anatomy's "
      "surface to a fraction of a voxel. It is made by a window of HU with hysteresis, morphology in mm, a choice of "
      "components and filled cavities.";
  s.examples = {"trephine segment head.nrrd --output skull.nrrd",
                "trephine segment head.nrrd --lower-hu -475 --open-mm 3 --components largest --fill cavities_and_cut "
                "--fill-close-mm 6 --output skin.nrrd"};
  s.ports = {port("volume", DataKind::volume).help("CT volume in HU"),
             port("within", DataKind::field).optional().help("an anatomy to stay inside of"),
             port("without", DataKind::field).optional().help("an anatomy to stay outside of")};
  s.output = DataKind::field;
  s.declares<segmentation::SegmentParams, segmentation::SegmentResult>();
  s.run = [](const AnyParams& params, const StageInputs& in, const Progress& progress) {
    const segmentation::SegmentMasks masks{in.get<grid::Field>("within"), in.get<grid::Field>("without")};
    return stage_outcome(segmentation::segment(*in.get<grid::HuVolume>("volume"), masks,
                                               params.as<segmentation::SegmentParams>(), progress));
  };
  return s;
}

}  // namespace trephine::stages
