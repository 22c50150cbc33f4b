// SPDX-License-Identifier: GPL-3.0-or-later
#include "grid/resample.h"

#include <fmt/format.h>

#include "stages/stage.h"

namespace trephine::stages {

StageType resample_stage() {
  StageType s;
  s.name = "resample";
  s.version = 1;
  s.typical.base_s = 1;
  s.place = StagePlace::scan;
  s.in_every_recipe = true;
  s.summary = "puts a CT volume on voxels of another size";
  s.description =
      "Each value is the mean over the new voxel, as a scanner with such voxels would measure it. Voxels smaller than "
      "the scan's are interpolated. Larger voxels make all later stages faster and coarser.";
  s.examples = {"trephine resample head.nrrd --spacing-mm 1 1 1 --output coarse.nrrd"};
  s.ports = {port("volume", DataKind::volume).from(From::import).help("CT volume in HU")};
  s.output = DataKind::volume;
  s.declares<grid::ResampleParams, grid::ResampleResult>();
  s.contribute = [](const AnyParams& result, CaseParts& parts) {
    // Deviations are measured from the surface on the voxels that it was made on, and say nothing of what coarser ones
    // lost.
    const auto& r = result_as<grid::ResampleResult>(result);
    if (!(r.coarsest_ratio > 1 + 1e-6)) return;
    const double percent = 100 * r.voxels_ratio;
    parts.remarks.push_back(
        fmt::format("on voxels of {:.3g} x {:.3g} x {:.3g} mm, {:.{}f} % of the scan's: the deviations leave out what "
                    "that loses (`trade` measures it)",
                    r.spacing_mm[0], r.spacing_mm[1], r.spacing_mm[2], percent, percent < 10 ? 1 : 0));
  };
  s.run = [](const AnyParams& params, const StageInputs& in, const Progress& progress) {
    return stage_outcome(
        grid::resample(*in.get<grid::HuVolume>("volume"), params.as<grid::ResampleParams>(), progress));
  };
  return s;
}

}  // namespace trephine::stages
