// SPDX-License-Identifier: GPL-3.0-or-later
#include "segmentation/vessels.h"

#include "place/cranium.h"
#include "stages/stage.h"

namespace trephine::stages {

StageType vessels_stage() {
  StageType s;
  s.name = "vessels";
  s.version = 2;
  s.typical.base_s = 4;
  s.summary = "finds the vessels that a CT angiography shows";
  s.description =
      "Subtracts the CT from an angiography that lies on its voxels (scan: cta in a recipe, or what `register` wrote), "
      "and takes what is brighter in the cranial cavity: sinuses, cortical veins and arteries; or, of a neck or trunk, "
      "in its soft tissue. As an anatomy of a recipe they are a zone that burr holes can be held clear of.";
  s.examples = {
      "trephine vessels cta_on_ct.nrrd --ct head.nrrd --skull skull.nrrd --output vessels.nrrd",
      "trephine burrhole skull.vtp --at position --position-mm -30,-40,70 --avoid vessels=3 --zone vessels=vessels.vtp "
      "--output hole.json"};
  s.ports = {
      port("volume", DataKind::volume).help("CT angiography on the CT's voxels"),
      port("ct", DataKind::volume).from(From::ct).help("CT volume in HU"),
      port("skull", DataKind::field)
          .optional()
          .help("the skull that encloses the brain, or all bone of a trunk; without it, bone is every voxel above 226 "
                "HU"),
      port("within", DataKind::field).optional().help("an anatomy to stay inside of, such as the zone of a sinus"),
      port("without", DataKind::field)
          .optional()
          .help("an anatomy to leave out, such as the vein where arteries are sought")};
  s.output = DataKind::field;
  s.declares<segmentation::VesselsParams, segmentation::VesselsResult>();
  s.run = [](const AnyParams& any, const StageInputs& in, const Progress& progress) {
    const grid::HuVolume& ct = *in.get<grid::HuVolume>("ct");
    const grid::Field* skull = in.get<grid::Field>("skull");
    const mask::BitMask bone = skull ? mask::positive(*skull, grid::lattice_of(ct)) : place::bone_of(mask::HuView(ct));
    const auto& params = any.as<segmentation::VesselsParams>();
    mask::BitMask region;
    std::optional<double> cavity_ml;
    Warnings warnings;
    if (params.region == segmentation::VesselRegion::soft_tissue) {
      region = segmentation::soft_tissue_around(ct, bone);
    } else {
      auto cavity = place::cranial_cavity(bone, progress.part(0, 0.4));
      region = std::move(cavity.value);
      cavity_ml = cavity.result.cranial_cavity_ml;
      warnings = std::move(cavity.warnings);
    }
    auto made = segmentation::find_vessels(*in.get<grid::HuVolume>("volume"), ct, region, in.get<grid::Field>("within"),
                                           in.get<grid::Field>("without"), params, progress.part(0.4, 1));
    made.result.cranial_cavity_ml = cavity_ml;
    made.warnings.insert(made.warnings.begin(), warnings.begin(), warnings.end());
    return stage_outcome(std::move(made));
  };
  return s;
}

}  // namespace trephine::stages
