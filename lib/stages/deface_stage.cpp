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
  s.removes_face = true;
  s.case_figures = "face.";
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
  s.make_params = [] { return AnyParams::make<face::DefaceParams>(); };
  s.run = [](const AnyParams& params, const StageInputs& in, Report& report, const Progress& progress) -> StageData {
    const auto& p = params.as<face::DefaceParams>();
    const grid::Field& skin = *in.get<grid::Field>("skin");
    const auto regions =
        face::face_regions(*in.get<head::HeadLandmarks>("landmarks"), in.get<head::HeadLandmarks>("found"), skin, p);
    return std::make_shared<const grid::HuVolume>(
        face::deface(*in.get<grid::HuVolume>("volume"), skin, regions, p, report, progress));
  };
  return s;
}

}  // namespace trephine::stages
