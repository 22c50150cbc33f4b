// SPDX-License-Identifier: GPL-3.0-or-later
#include "segmentation/t1_contrast.h"

#include "place/cranium.h"
#include "stages/stage.h"

namespace trephine::stages {

StageType t1_contrast_stage() {
  StageType s;
  s.name = "t1_contrast";
  s.version = 1;
  s.typical.base_s = 4;
  s.summary = "makes a T1-weighted MR readable for the stages that find brain and ventricles";
  s.description =
      "Takes an MR that lies on the CT's voxels (scan: mr in a recipe, or what `register` wrote), takes off the coil's "
      "bias field, and gives it in the cranial cavity as if it were a CT: CSF at 8 HU, tissue at 30. Outside of the "
      "cavity the CT stays. `brain` and `ventricles` then follow in the recipe.";
  s.examples = {"trephine t1-contrast mr_on_ct.nrrd --ct head.nrrd --skull skull.nrrd --output t1.nrrd",
                "trephine ventricles t1.nrrd --brain brain.nrrd --output ventricles.nrrd"};
  s.ports = {port("volume", DataKind::volume).help("T1-weighted MR on the CT's voxels"),
             port("ct", DataKind::volume).from(From::ct).help("CT volume in HU"),
             port("skull", DataKind::field)
                 .optional()
                 .help("the skull that encloses the brain; without it, bone is every voxel above 226 HU")};
  s.output = DataKind::volume;
  s.declares<segmentation::T1ContrastParams, segmentation::T1ContrastResult>();
  s.run = [](const AnyParams& any, const StageInputs& in, const Progress& progress) {
    const grid::HuVolume& ct = *in.get<grid::HuVolume>("ct");
    const grid::Field* skull = in.get<grid::Field>("skull");
    const mask::BitMask bone = skull ? mask::positive(*skull, grid::lattice_of(ct)) : place::bone_of(mask::HuView(ct));
    const auto cavity = place::cranial_cavity(bone, progress.part(0, 0.4));
    auto made = segmentation::t1_contrast(*in.get<grid::HuVolume>("volume"), ct, cavity.value,
                                          any.as<segmentation::T1ContrastParams>(), progress.part(0.4, 1));
    made.result.cranial_cavity_ml = cavity.result.cranial_cavity_ml;
    made.warnings.insert(made.warnings.begin(), cavity.warnings.begin(), cavity.warnings.end());
    return stage_outcome(std::move(made));
  };
  return s;
}

}  // namespace trephine::stages
