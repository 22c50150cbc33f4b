// SPDX-License-Identifier: GPL-3.0-or-later
#include "segmentation/t1_contrast.h"

#include "head/cranium.h"
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
  s.make_params = [] { return AnyParams::make<segmentation::T1ContrastParams>(); };
  s.run = [](const AnyParams& any, const StageInputs& in, Report& report, const Progress& progress) -> StageData {
    const grid::HuVolume& ct = *in.get<grid::HuVolume>("ct");
    const grid::Field* skull = in.get<grid::Field>("skull");
    const mask::BitMask bone = skull ? mask::positive(*skull, grid::lattice_of(ct)) : head::bone_of(mask::HuView(ct));
    const mask::BitMask cavity = head::cranial_cavity(bone, report, progress.part(0, 0.4));
    return std::make_shared<const grid::HuVolume>(
        segmentation::t1_contrast(*in.get<grid::HuVolume>("volume"), ct, cavity,
                                  any.as<segmentation::T1ContrastParams>(), report, progress.part(0.4, 1)));
  };
  return s;
}

}  // namespace trephine::stages
