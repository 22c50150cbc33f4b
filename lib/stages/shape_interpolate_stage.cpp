// SPDX-License-Identifier: GPL-3.0-or-later
#include "mask/shape_interpolate.h"

#include "stages/stage.h"

namespace trephine::stages {

StageType shape_interpolate_stage() {
  StageType s;
  s.name = "shape_interpolate";
  s.version = 1;
  s.typical.base_s = 0.02;
  s.typical.per_million_voxels_s = 0.001;
  s.summary = "adds slices between thick ones, so that surfaces have no terraces";
  s.description =
      "Thick slices make a surface that is nearly parallel to them a flight of terraces. Between two slices the "
      "outline "
      "is led smoothly from one to the next (shape-based interpolation); the outlines of the given slices stay where "
      "they are, and thin parts stay joined. A scan of thin slices passes unchanged.";
  s.examples = {"trephine shape-interpolate skin.nrrd --output smooth.nrrd"};
  s.ports = {port("field", DataKind::field).help("field of the segment stage")};
  s.output = DataKind::field;
  s.effect = StageEffect::changes_raster;
  s.declares<mask::ShapeInterpolateParams, mask::ShapeInterpolateResult>();
  s.run = [](const AnyParams& params, const StageInputs& in, const Progress& progress) {
    return stage_outcome(mask::shape_interpolate(std::get<std::shared_ptr<const grid::Field>>(in.by_port.at("field")),
                                                 params.as<mask::ShapeInterpolateParams>(), progress));
  };
  return s;
}

}  // namespace trephine::stages
