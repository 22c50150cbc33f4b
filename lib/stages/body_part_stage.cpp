// SPDX-License-Identifier: GPL-3.0-or-later
#include "look/body_part.h"

#include "stages/stage.h"

namespace trephine::stages {

StageType body_part_stage() {
  StageType s;
  s.name = "body_part";
  s.version = 3;
  s.typical.base_s = 0.1;
  s.typical.per_million_voxels_s = 0.012;
  s.place = StagePlace::scan;
  s.check.serves = "what part of the body the scan shows";
  s.check.recognises = true;
  s.in_every_recipe = true;
  s.summary = "says whether a scan shows a head, lungs or a spine, before anything is made of it";
  s.description =
      "Looks at cells of 3 mm for a cranial cavity, for lungs and for the canal of a spine. Where the scan surely "
      "shows another part of the body than the expected one, it is refused at once, with the recipe that fits; where "
      "only no cranial cavity is seen, as in a scan of a jaw, a head's recipe goes on with a warning. What it lets "
      "pass, the stages that look for the part may still refuse.";
  s.examples = {"trephine body-part scan.nrrd --expected head --report seen.json"};
  s.ports = {port("volume", DataKind::volume).from(From::import).help("CT volume in HU")};
  s.output = DataKind::nothing;
  s.declares<look::BodyPartParams, look::BodyPartResult>();
  s.contribute = [](const AnyParams& result, CaseParts& parts) {
    parts.checks = figures_named("body_part.", result);
    if (result_as<look::BodyPartResult>(result).is_expected != look::IsExpected::unknown) return;
    parts.evidence.push_back({});
    parts.remarks.push_back("it is not sure that the scan shows the part of the body that is made of it");
  };
  s.run = [](const AnyParams& params, const StageInputs& in, const Progress& progress) {
    return stage_outcome(
        look::judge_body_part(*in.get<grid::HuVolume>("volume"), params.as<look::BodyPartParams>(), progress));
  };
  return s;
}

}  // namespace trephine::stages
