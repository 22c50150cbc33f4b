// SPDX-License-Identifier: GPL-3.0-or-later
#include "segmentation/speed_image.h"
#include "stages/stage.h"

namespace trephine {

StageType presegment_stage() {
  StageType s;
  s.name = "presegment";
  s.version = 1;
  s.summary = "makes the speed image that drives a snake";
  s.description =
      "Gives a field on the volume's voxels, from -1 (the surface moves inwards) over 0 (it rests) to 1 (outwards): by "
      "a smooth window of HU, by the image's edges, or by tissue classes found by clustering, as ITK-SNAP does before "
      "its snake, with its defaults, but in mm. A window ends halfway between the structure's HU and its neighbour's "
      "as this scan has them (CSF of -5 and brain of 21: 8), well beyond them on the other side; noise is smoothed "
      "first.";
  s.examples = {
      "trephine presegment head.nrrd --lower-hu -40 --upper-hu 8 --smoothing-sigma-mm 0.7 --within brain.nrrd "
      "--output speed.nrrd",
      "trephine presegment head.nrrd --method edges --edge-kappa-hu-per-mm 4 --within brain.nrrd --output "
      "edges.nrrd"};
  s.ports = {{"volume", DataKind::volume, true, "CT volume in HU"},
             {"within", DataKind::field, false, "an anatomy to look inside of; the speed is -1 outside"},
             {"without", DataKind::field, false, "an anatomy to look outside of; the speed is -1 inside"}};
  s.output = DataKind::field;
  s.make_params = [] { return AnyParams::make<PresegmentParams>(); };
  s.run = [](const AnyParams& params, const StageInputs& in, Report& report, const Progress& progress) -> StageData {
    const PresegmentMasks masks{in.get<Field>("within"), in.get<Field>("without")};
    return std::make_shared<const Field>(
        presegment(*in.get<HuVolume>("volume"), masks, params.as<PresegmentParams>(), report, progress));
  };
  return s;
}

}  // namespace trephine
