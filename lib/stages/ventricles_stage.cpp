// SPDX-License-Identifier: GPL-3.0-or-later
#include "head/ventricles.h"

#include "stages/stage.h"

namespace trephine::stages {

StageType ventricles_stage() {
  StageType s;
  s.name = "ventricles";
  s.version = 6;
  s.typical.base_s = 1;
  s.typical.per_million_voxels_s = 0.065;
  s.typical.surface_million = 0.07;
  s.summary = "finds the ventricles inside the brain";
  s.description =
      "Gives a field on the volume's voxels that is positive inside the lateral ventricles and the third. They are the "
      "CSF deep in the brain; a seeded watershed separates it from cisterns, fourth ventricle and sulci where the "
      "passages between them are narrowest. The edge is fitted to the scan between the voxels.";
  s.examples = {"trephine ventricles head.nrrd --brain brain.nrrd --output ventricles.nrrd"};
  s.ports = {port("volume", DataKind::volume).help("CT volume in HU"),
             port("brain", DataKind::field).help("the brain that holds the ventricles"),
             port("without", DataKind::field).optional().help("an anatomy to stay outside of")};
  s.output = DataKind::field;
  s.declares<head::VentriclesParams, head::VentriclesResult>();
  s.run = [](const AnyParams& params, const StageInputs& in, const Progress& progress) {
    const head::VentriclesMasks masks{in.get<grid::Field>("brain"), in.get<grid::Field>("without")};
    return stage_outcome(
        head::find_ventricles(*in.get<grid::HuVolume>("volume"), masks, params.as<head::VentriclesParams>(), progress));
  };
  return s;
}

}  // namespace trephine::stages
