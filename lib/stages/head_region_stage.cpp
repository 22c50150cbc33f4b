// SPDX-License-Identifier: GPL-3.0-or-later
#include "head/head_region.h"

#include "stages/stage.h"

namespace trephine::stages {

StageType head_region_stage() {
  StageType s;
  s.name = "head_region";
  s.version = 8;
  s.typical.base_s = 0.05;
  s.typical.per_million_voxels_s = 0.02;
  s.place = StagePlace::scan;
  s.summary = "cuts a scan to the region of the head";
  s.description =
      "Finds the cranial cavity and the foramen magnum, and keeps the head with a part of the neck, on the same "
      "voxels. "
      "What the scan does not show of the head (vertex, base, a side outside of the field of view) is reported.";
  s.examples = {"trephine head-region neck.nrrd --output head.nrrd"};
  s.ports = {port("volume", DataKind::volume).help("CT volume in HU")};
  s.output = DataKind::volume;
  s.declares<head::HeadRegionParams, head::HeadRegionResult>();
  s.contribute = [](const AnyParams& result, CaseParts& parts) {
    for (const auto& [anatomy, where] : result_as<head::HeadRegionResult>(result).cut)
      parts.evidence.push_back({anatomy, where, ""});
  };
  s.run = [](const AnyParams& params, const StageInputs& in, const Progress& progress) {
    return stage_outcome(
        head::head_region(*in.get<grid::HuVolume>("volume"), params.as<head::HeadRegionParams>(), progress));
  };
  return s;
}

}  // namespace trephine::stages
