// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <utility>

#include "mask/scan_verdict.h"
#include "stages/stage.h"

namespace trephine::stages {

StageType scan_stage() {
  StageType s;
  s.name = "scan";
  s.version = 5;
  s.typical.base_s = 0;
  s.typical.per_million_voxels_s = 0.006;
  s.place = StagePlace::scan;
  s.check.serves = "what the scan is suited for";
  s.summary = "measures noise, kernel and artefacts of a head's scan and says what it is suited for";
  s.description =
      "Noise is the standard deviation of a voxel and of the mean over a cube of 2 mm, in tiles of even soft tissue "
      "within the skull; the kernel shows in how neighbours go together and in the skin's edge. The verdict on brain, "
      "ventricles and skull is suited, doubtful or unsuited, each with what to do. Where the head moved between two "
      "slices (by 1.5 mm or more, in slices up to 3 mm apart), it says where and by how much.";
  s.examples = {"trephine scan head.nrrd --report scan.json"};
  s.ports = {port("volume", DataKind::volume).from(From::import).help("CT volume in HU")};
  s.output = DataKind::nothing;
  s.declares<mask::ScanLimits, mask::ScanResult>();
  s.contribute = [](const AnyParams& result, CaseParts& parts) {
    const auto& scan = result_as<mask::ScanResult>(result);
    parts.checks = figures_named("scan.", result);
    for (const auto& [anatomy, is, why] : {std::tuple{"brain", scan.suited.brain, &scan.because.brain},
                                           {"ventricles", scan.suited.ventricles, &scan.because.ventricles},
                                           {"skull", scan.suited.skull, &scan.because.skull},
                                           {"skin", scan.suited.skin, &scan.because.skin}})
      if (is == mask::Suitability::doubtful || is == mask::Suitability::unsuited)
        parts.evidence.push_back({anatomy, "", *why});
  };
  s.run = [](const AnyParams& params, const StageInputs& in, const Progress& progress) {
    return stage_outcome(mask::judge_scan(*in.get<grid::HuVolume>("volume"), params.as<mask::ScanLimits>(), progress));
  };
  return s;
}

}  // namespace trephine::stages
