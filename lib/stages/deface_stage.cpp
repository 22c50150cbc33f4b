// SPDX-License-Identifier: GPL-3.0-or-later
#include "face/deface.h"

#include "stages/stage.h"

namespace trephine {

StageType deface_stage() {
  StageType s;
  s.name = "deface";
  s.version = 1;
  s.place = StagePlace::scan;
  s.summary = "takes the face off a CT volume";
  s.description =
      "In front of the plane through the tragi and below the nasion, everything near the skin of the original scan "
      "becomes air. The rest is rounded and closed, so that neither the volume nor any surface made of it shows the "
      "face. The cranium, the brain and everything above the nasion keep their values.";
  s.examples = {"trephine deface head.nrrd --skin skin.nrrd --landmarks landmarks.json --output defaced.nrrd",
                "trephine deface head.nrrd --skin skin.nrrd --landmarks landmarks.json --policy crop "
                "--output cropped.nrrd"};
  s.ports = {{"volume", DataKind::volume, true, "CT volume in HU"},
             {"skin", DataKind::field, true, "the skin of this volume, as segment finds it"},
             {"landmarks", DataKind::landmarks, true, "nasion, tragus_left and tragus_right"}};
  s.output = DataKind::volume;
  s.make_params = [] { return AnyParams::make<DefaceParams>(); };
  s.run = [](const AnyParams& params, const StageInputs& in, Report& report, const Progress& progress) -> StageData {
    return std::make_shared<const HuVolume>(deface(*in.get<HuVolume>("volume"), *in.get<Field>("skin"),
                                                   face_region(*in.get<HeadLandmarks>("landmarks")),
                                                   params.as<DefaceParams>(), report, progress));
  };
  return s;
}

}  // namespace trephine
