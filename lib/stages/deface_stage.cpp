// SPDX-License-Identifier: GPL-3.0-or-later
#include "face/face_belief.h"

#include "stages/stage.h"

namespace trephine::stages {

StageType deface_stage() {
  StageType s;
  s.name = "deface";
  s.version = 4;
  s.typical.base_s = 3;
  s.place = StagePlace::scan;
  s.effect = StageEffect::removes_face;
  s.contribute = [](const AnyParams& result, CaseParts& parts) { parts.changes = figures_named("face.", result); };
  s.summary = "takes the face off a CT volume";
  s.description =
      "In front of the plane through the tragi and below the nasion, everything near the skin of the original scan "
      "becomes air. The rest is rounded and closed, so that neither the volume nor any surface made of it shows the "
      "face. The cranium, the brain and everything from 6 mm above the nasion upwards keep their values.";
  s.examples = {"trephine deface head.nrrd --skin skin.nrrd --landmarks landmarks.json --output defaced.nrrd",
                "trephine deface head.nrrd --skin skin.nrrd --landmarks landmarks.json --policy crop "
                "--output cropped.nrrd"};
  s.ports = {port("volume", DataKind::volume).from(From::original_scan).help("CT volume in HU"),
             port("skin", DataKind::field).help("the skin of this volume, as segment finds it"),
             port("landmarks", DataKind::landmarks)
                 .from(From::original_landmarks)
                 .help("landmarks nasion, tragus_left and tragus_right"),
             port("found", DataKind::landmarks)
                 .from(From::found_landmarks)
                 .optional()
                 .help("the same landmarks, found without any that a person gave")};
  s.output = DataKind::volume;
  s.declares<face::DefaceParams, face::DefaceResult>();
  s.run = [](const AnyParams& params, const StageInputs& in, const Progress& progress) {
    const auto& p = params.as<face::DefaceParams>();
    const grid::Field& skin = *in.get<grid::Field>("skin");
    const auto regions =
        face::face_regions(*in.get<head::HeadLandmarks>("landmarks"), in.get<head::HeadLandmarks>("found"), skin, p);
    return stage_outcome(face::deface(*in.get<grid::HuVolume>("volume"), skin, regions, p, progress));
  };
  return s;
}

}  // namespace trephine::stages
