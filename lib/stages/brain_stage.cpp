// SPDX-License-Identifier: GPL-3.0-or-later
#include "head/brain.h"

#include "stages/scan_figures_of.h"
#include "stages/stage.h"

namespace trephine::stages {

StageType brain_stage() {
  StageType s;
  s.name = "brain";
  s.version = 8;
  s.typical.base_s = 0.3;
  s.typical.per_million_voxels_s = 0.075;
  s.typical.surface_million = 0.9;
  s.summary = "finds the brain inside the skull";
  s.description =
      "Gives a field on the volume's voxels that is positive inside the brain and follows its sulci. A seeded "
      "watershed finds the space inside the skull; the brain is the tissue in it that is brighter than CSF, as far as "
      "the scan's noise allows to tell. The ventricles belong to the brain.";
  s.examples = {"trephine brain head.nrrd --skull skull.nrrd --output brain.nrrd"};
  s.ports = {port("volume", DataKind::volume).help("CT volume in HU"),
             port("skull", DataKind::field)
                 .optional()
                 .help("the skull that encloses the brain; without it, bone is every voxel above 226 HU"),
             port("within", DataKind::field).optional().help("an anatomy to stay inside of"),
             port("without", DataKind::field).optional().help("an anatomy to stay outside of")};
  s.output = DataKind::field;
  s.declares<head::BrainParams, head::BrainResult>();
  s.run = [](const AnyParams& params, const StageInputs& in, const Progress& progress) {
    const head::BrainMasks masks{in.get<grid::Field>("skull"), in.get<grid::Field>("within"),
                                 in.get<grid::Field>("without"),
                                 [&in](const Progress& rest) { return scan_figures_of(in, rest); }};
    return stage_outcome(
        head::find_brain(*in.get<grid::HuVolume>("volume"), masks, params.as<head::BrainParams>(), progress));
  };
  return s;
}

}  // namespace trephine::stages
