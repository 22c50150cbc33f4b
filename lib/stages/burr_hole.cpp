// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/burr_hole.h"

#include <cmath>

#include "base/error.h"

namespace trephine {

// Scalp and a careless hand; what lies further away is rather a mistake.
constexpr double far_position_mm = 15;

BurrHoleRequest request_of(const BurrHoleParams& params, const std::string& name,
                           const std::map<std::string, Vec3>& landmarks_mm, ExitCode code) {
  BurrHoleRequest r;
  r.at = params.at;
  r.side = params.side;
  r.name = name;
  r.position_mm = {params.position_mm[0], params.position_mm[1], params.position_mm[2]};
  r.diameter_mm = params.diameter_mm;
  const bool has_position = norm(r.position_mm) > 0;
  if (params.at == BurrHoleRequest::At::position && !has_position)
    throw Error(code, "", "position_mm", "is missing: `at` is position");
  if (params.at == BurrHoleRequest::At::kocher) {
    if (has_position) throw Error(code, "", "position_mm", "is not looked at where `at` is kocher");
    const auto known = [&](const char* landmark) { return landmarks_mm.count(landmark) > 0; };
    if (!known("nasion") || !(known("inion") || known("vertex")))
      throw Error(code, "", "landmarks",
                  std::string(!known("nasion") ? "nasion" : "inion") +
                      ", is missing: Kocher's point is measured from the nasion along the midline to the inion (or "
                      "vertex); give landmarks in mm, LPS");
  }
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
  s.version = 2;
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
    if (request.at == BurrHoleRequest::At::position) {
      const double moved_mm = norm(hole.position_mm - request.position_mm);
      report.add("entry_from_position_mm", moved_mm);
      if (moved_mm > far_position_mm)
        report.warn("the bone lies " + to_text(ParameterValue(std::round(moved_mm))) + " mm from position_mm");
    }
    return std::make_shared<const std::vector<Cutter>>(std::vector<Cutter>{hole.cutter});
  };
  return s;
}

}  // namespace trephine
