// SPDX-License-Identifier: GPL-3.0-or-later
#include "body/body.h"

#include "stages/stage.h"

namespace trephine::stages {

StageType body_stage() {
  StageType s;
  s.name = "body";
  s.version = 4;
  s.typical.base_s = 0.05;
  s.typical.per_million_voxels_s = 0.041;
  s.place = StagePlace::scan;
  s.effect = StageEffect::draws_removal;
  s.summary = "takes mask, couch and other apparatus off a scan";
  s.description =
      "Finds the body from inside out and makes air of everything else: radiotherapy mask, couch, head holder, clamps, "
      "pillows, leads and tubes. Ears and nose stay, and so does what the body encloses. The report says how much was "
      "taken away. A scan without apparatus stays as it is.";
  s.examples = {"trephine body head.nrrd --output body.nrrd"};
  s.ports = {port("volume", DataKind::volume).help("CT volume in HU")};
  s.output = DataKind::volume;
  s.declares<body::BodyParams, body::BodyResult>();
  s.run = [](const AnyParams& params, const StageInputs& in, const Progress& progress) {
    return stage_outcome(body::keep_body(*in.get<grid::HuVolume>("volume"), params.as<body::BodyParams>(), progress));
  };
  return s;
}

}  // namespace trephine::stages
