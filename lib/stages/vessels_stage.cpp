// SPDX-License-Identifier: GPL-3.0-or-later
#include "segmentation/vessels.h"

#include "head/cranium.h"
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
  s.make_params = [] { return AnyParams::make<segmentation::VesselsParams>(); };
  s.run = [](const AnyParams& any, const StageInputs& in, Report& report, const Progress& progress) -> StageData {
    const grid::HuVolume& ct = *in.get<grid::HuVolume>("ct");
    const grid::Field* skull = in.get<grid::Field>("skull");
    const mask::BitMask bone = skull ? mask::positive(*skull, grid::lattice_of(ct)) : head::bone_of(mask::HuView(ct));
    const auto& params = any.as<segmentation::VesselsParams>();
    const mask::BitMask region = params.region == segmentation::VesselRegion::soft_tissue
                                     ? segmentation::soft_tissue_around(ct, bone)
                                     : head::cranial_cavity(bone, report, progress.part(0, 0.4));
    return std::make_shared<const grid::Field>(
        segmentation::find_vessels(*in.get<grid::HuVolume>("volume"), ct, region, in.get<grid::Field>("within"),
                                   in.get<grid::Field>("without"), params, report, progress.part(0.4, 1)));
  };
  return s;
}

}  // namespace trephine::stages
