// SPDX-License-Identifier: GPL-3.0-or-later
#include "trunk/vein.h"

#include "stages/stage.h"

namespace trephine::stages {

StageType vein_stage() {
  StageType s;
  s.name = "vein";
  s.version = 3;
  s.typical.base_s = 0.05;
  s.typical.per_million_voxels_s = 0.017;
  s.typical.surface_million = 0.03;
  s.summary = "finds or estimates the subclavian veins below the clavicles";
  s.description =
      "Gives a field in about mm that is positive inside the vein, from the middle of the clavicle to behind the "
      "sternum. Where contrast medium shows the vein, its surface lies at half the contrast. Where it does not, the "
      "vein is a tube of a given radius along the usual course behind and below the clavicle, away from bone and lung; "
      "the report then says estimated, and warns. Such a vein is good for teaching, but it is not where this patient's "
      "vein was found.";
  s.examples = {"trephine vein volume.nrrd --bone bone.nrrd --output vein.nrrd"};
  s.ports = {
      port("volume", DataKind::volume).help("CT volume in HU, in axial slices"),
      port("bone", DataKind::field).help("all bone of the chest, filled"),
      port("lung", DataKind::field)
          .optional()
          .help("the lungs: a side that shows less than 20 ml, and a lung of which a part is missing, are warned of")};
  s.output = DataKind::field;
  s.declares<trunk::VeinParams, trunk::VeinResult>();
  s.run = [](const AnyParams& params, const StageInputs& in, const Progress& progress) {
    return stage_outcome(trunk::find_vein(*in.get<grid::HuVolume>("volume"), *in.get<grid::Field>("bone"),
                                          params.as<trunk::VeinParams>(), progress, in.get<grid::Field>("lung")));
  };
  return s;
}

}  // namespace trephine::stages
