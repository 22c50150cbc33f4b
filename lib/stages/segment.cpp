// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/error.h"
#include "stages/coarse_segment.h"
#include "stages/stage.h"

namespace trephine {

StageType segment_stage() {
  StageType s;
  s.name = "segment";
  s.version = 9;
  s.summary = "finds one anatomy in a CT volume";
  s.description =
      "Gives a field on the volume's voxels, positive inside the anatomy, whose zero crossing is its surface to a "
      "fraction of a voxel. Methods: threshold (with hysteresis, morphology in mm, components and filled cavities), "
      "and an unattended brain and ventricles.";
  s.ports = {{"volume", DataKind::volume, true, "CT volume in HU"},
             {"within", DataKind::field, false, "an anatomy to stay inside of"},
             {"without", DataKind::field, false, "an anatomy to stay outside of"},
             {"skull", DataKind::field, false, "the skull, for the brain that it holds"}};
  s.output = DataKind::field;
  s.make_params = [] { return AnyParams::make<SegmentStageParams>(); };
  s.run = [](const AnyParams& params, const StageInputs& in, Report& report, const Progress& progress) -> StageData {
    const SegmentMasks masks{in.get<Field>("within"), in.get<Field>("without"), in.get<Field>("skull")};
    const auto& p = params.as<SegmentStageParams>();
    const HuVolume& volume = *in.get<HuVolume>("volume");
    if (p.coarse_mm > 0 && (masks.within || masks.without || masks.skull || p.method != SegmentMethod::threshold))
      throw Error(ExitCode::usage, "", "coarse_mm", "only for method threshold, and without another anatomy");
    return std::make_shared<const Field>(p.coarse_mm > 0 ? segment_coarsely(volume, p, report, progress)
                                                         : segment(volume, masks, p, report, progress));
  };
  return s;
}

}  // namespace trephine
