// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/points.h"

#include "base/error.h"
#include "stages/stage.h"

namespace trephine::stages {

StageType points_stage() {
  StageType s;
  s.name = "points";
  s.version = 1;
  s.place = StagePlace::scene;
  s.case_name = "given_landmarks";
  s.summary = "makes a list of landmarks that a person placed";
  s.description =
      "Makes the landmarks that `landmarks` and `burrhole` take as given. Each has a name, a position, and a "
      "confidence of 1 unless another one is set.";
  s.examples = {
      "trephine points --landmarks nasion:position_mm=0,-95,10 --landmarks inion:position_mm=0,98,0 --output "
      "given.json"};
  s.output = DataKind::landmarks;
  s.make_params = [] { return AnyParams::make<PointsParams>(); };
  s.run = [](const AnyParams& params, const StageInputs&, Report& report, const Progress&) -> StageData {
    head::HeadLandmarks all;
    if (params.as<PointsParams>().landmarks.empty())
      throw Error(ExitCode::usage, "", "landmarks", "none is given: say NAME:position_mm=X,Y,Z");
    for (const auto& [name, p] : params.as<PointsParams>().landmarks)
      all.landmarks.push_back({name, {p.position_mm[0], p.position_mm[1], p.position_mm[2]}, p.confidence, p.source});
    report.add("landmarks_count", all.landmarks.size());
    return std::make_shared<const head::HeadLandmarks>(std::move(all));
  };
  return s;
}

}  // namespace trephine::stages
