// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/burr_hole.h"

#include "base/error.h"

namespace trephine {

BurrHoleRequest request_of(const BurrHoleParams& params, const std::string& name,
                           const std::map<std::string, Vec3>& landmarks_mm, ExitCode code) {
  BurrHoleRequest r;
  r.at = params.at;
  r.side = params.side;
  r.name = name;
  r.position_mm = {params.position_mm[0], params.position_mm[1], params.position_mm[2]};
  r.diameter_mm = params.diameter_mm;
  r.along_mm = params.along_mm;
  r.lateral_mm = params.lateral_mm;
  const Vec3 direction{params.direction[0], params.direction[1], params.direction[2]};
  const double length = norm(direction);
  if (length > 0 && !params.toward.empty())
    throw Error(code, "", "direction", "and toward contradict each other, give one of them");
  if (length > 0) r.direction = direction / length;
  if (!params.toward.empty()) {
    const auto found = landmarks_mm.find(params.toward);
    if (found == landmarks_mm.end()) throw Error(code, "", "toward", params.toward + ", no such landmark is given");
    r.toward_mm = found->second;
  }
  return r;
}

StageType burr_hole_stage(const std::string& name, std::map<std::string, Vec3> landmarks_mm) {
  StageType s;
  s.name = "burr_hole";
  s.version = 1;
  s.summary = "places a burr hole on a head";
  s.description =
      "At Kocher's point, measured over the skin from landmarks, or at a position; its axis is given, points at a "
      "landmark, or is perpendicular to the skull. The result is the cutter that `boolean` takes, for surfaces and "
      "haptic "
      "volumes alike.";
  s.ports = {{"skull", DataKind::mesh, true, "surface of the skull, not decimated"},
             {"skin", DataKind::mesh, false, "surface of the skin, over which Kocher's point is measured"}};
  s.output = DataKind::cutters;
  s.make_params = [] { return AnyParams::make<BurrHoleParams>(); };
  s.run = [name, landmarks = std::move(landmarks_mm)](const AnyParams& params, const StageInputs& in, Report& report,
                                                      const Progress&) -> StageData {
    const BurrHoleRequest request = request_of(params.as<BurrHoleParams>(), name, landmarks, ExitCode::bad_config);
    const BurrHole hole =
        place_burr_hole(request, landmarks, in.get<TriMesh>("skin"), *in.get<TriMesh>("skull"), report);
    return std::make_shared<const std::vector<Cutter>>(std::vector<Cutter>{hole.cutter});
  };
  return s;
}

}  // namespace trephine
