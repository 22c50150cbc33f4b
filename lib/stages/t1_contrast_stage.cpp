// SPDX-License-Identifier: GPL-3.0-or-later
#include "segmentation/t1_contrast.h"

#include "head/cranium.h"
#include "stages/stage.h"

namespace trephine {

StageType t1_contrast_stage() {
  StageType s;
  s.name = "t1_contrast";
  s.version = 1;
  s.typical_s = 4;
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
  s.make_params = [] { return AnyParams::make<T1ContrastParams>(); };
  s.run = [](const AnyParams& any, const StageInputs& in, Report& report, const Progress& progress) -> StageData {
    using namespace segmentation;
    const HuVolume& ct = *in.get<HuVolume>("ct");
    const Field* skull = in.get<Field>("skull");
    const BitMask bone = skull ? positive(*skull, lattice_of(ct)) : bone_of(HuView(ct));
    const BitMask cavity = cranial_cavity(bone, report, progress.part(0, 0.4));
    return std::make_shared<const HuVolume>(t1_contrast(*in.get<HuVolume>("volume"), ct, cavity,
                                                        any.as<T1ContrastParams>(), report, progress.part(0.4, 1)));
  };
  return s;
}

}  // namespace trephine
