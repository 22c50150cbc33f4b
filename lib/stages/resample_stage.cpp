// SPDX-License-Identifier: GPL-3.0-or-later
#include "grid/resample.h"

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
  s.make_params = [] { return AnyParams::make<grid::ResampleParams>(); };
  s.run = [](const AnyParams& params, const StageInputs& in, Report& report, const Progress& progress) -> StageData {
    return std::make_shared<const grid::HuVolume>(
        grid::resample(*in.get<grid::HuVolume>("volume"), params.as<grid::ResampleParams>(), report, progress));
  };
  return s;
}

}  // namespace trephine::stages
