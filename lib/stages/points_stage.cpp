// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/points.h"

#include "base/error.h"
#include "stages/stage.h"

namespace trephine::stages {

namespace {

struct PointsResult {
  std::size_t landmarks_count = 0;
  template <class V>
  static void describe(V& v) {
    v.integer(&PointsResult::landmarks_count, "landmarks_count", Range{}, "Landmarks.");
  }
};

}  // namespace

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
  s.declares<PointsParams, PointsResult>();
  s.run = [](const AnyParams& params, const StageInputs&, const Progress&) {
    head::HeadLandmarks all;
    if (params.as<PointsParams>().landmarks.empty())
      throw Error(ExitCode::usage, "", "landmarks", "none is given: say NAME:position_mm=X,Y,Z");
    for (const auto& [name, p] : params.as<PointsParams>().landmarks)
      all.landmarks.push_back({name, {p.position_mm[0], p.position_mm[1], p.position_mm[2]}, p.confidence, p.source});
    const PointsResult result{all.landmarks.size()};
    return stage_outcome(Outcome<head::HeadLandmarks, PointsResult>{std::move(all), result, {}});
  };
  return s;
}

}  // namespace trephine::stages
