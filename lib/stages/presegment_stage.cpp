// SPDX-License-Identifier: GPL-3.0-or-later
#include "segmentation/speed_image.h"
#include "stages/stage.h"

namespace trephine::stages {

StageType presegment_stage() {
  StageType s;
  s.name = "presegment";
  s.version = 1;
  s.typical.base_s = 1.5;
  s.summary = "makes the speed image that drives a snake";
  s.description =
      "Gives a field on the volume's voxels from -1 (the surface moves inwards) over 0 (it rests) to 1 (it moves "
      "outwards). The speed comes from a smooth window of HU, from the image's edges, or from tissue classes found by "
      "clustering, as ITK-SNAP does before its snake and with its defaults, but in mm. Set the limit of a window "
      "towards a neighbouring structure halfway between the HU of the two in this scan (8 for CSF of -5 and brain of "
      "21), and the other limit well beyond the structure's HU. Smooth noise first.";
  s.examples = {
      "trephine presegment head.nrrd --lower-hu -40 --upper-hu 8 --smoothing-sigma-mm 0.7 --within brain.nrrd "
      "--output speed.nrrd",
      "trephine presegment head.nrrd --method edges --edge-kappa-hu-per-mm 4 --within brain.nrrd --output "
      "edges.nrrd"};
  s.ports = {port("volume", DataKind::volume).help("CT volume in HU"),
             port("within", DataKind::field).optional().help("an anatomy to look inside of; the speed is -1 outside"),
             port("without", DataKind::field).optional().help("an anatomy to look outside of; the speed is -1 inside")};
  s.output = DataKind::field;
  s.declares<segmentation::PresegmentParams, segmentation::PresegmentResult>();
  s.run = [](const AnyParams& params, const StageInputs& in, const Progress& progress) {
    const segmentation::PresegmentMasks masks{in.get<grid::Field>("within"), in.get<grid::Field>("without")};
    return stage_outcome(segmentation::presegment(*in.get<grid::HuVolume>("volume"), masks,
                                                  params.as<segmentation::PresegmentParams>(), progress));
  };
  return s;
}

}  // namespace trephine::stages
