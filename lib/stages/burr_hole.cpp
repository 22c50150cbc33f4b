// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/burr_hole.h"

#include <cmath>

#include "base/error.h"

namespace trephine {

namespace {

// Scalp and a careless hand; what lies further away is rather a mistake.
constexpr double far_position_mm = 15;
constexpr const char* how_to_give = "; give it in mm, LPS: landmarks: {NAME: [x, y, z]}, or a landmarks_file";

Vec3 vector_of(const std::array<double, 3>& a) { return {a[0], a[1], a[2]}; }

// Those that are sure enough, by name.
std::map<std::string, Vec3> sure(const HeadLandmarks& found, double min_confidence) {
  std::map<std::string, Vec3> out;
  for (const CaseLandmark& l : found.landmarks)
    if (l.confidence >= min_confidence) out[l.name] = l.position_mm;
  return out;
}

[[noreturn]] void refuse_missing(const std::string& name, const HeadLandmarks* found, double min_confidence,
                                 ExitCode code) {
  const CaseLandmark* unsure = found ? found->find(name) : nullptr;
  const auto text = [](double v) { return to_text(ParameterValue(std::round(v * 100) / 100)); };
  throw Error(code, "", "landmarks." + name,
              (unsure  ? "was found with confidence " + text(unsure->confidence) + ", below " + text(min_confidence)
               : found ? "was not found"
                       : "is missing") +
                  std::string(how_to_give));
}

}  // namespace

void check_request(const BurrHoleParams& params, ExitCode code) {
  const bool has_position = norm(vector_of(params.position_mm)) > 0;
  if (params.at == BurrHoleRequest::At::position && !has_position)
    throw Error(code, "", "position_mm", "is missing: `at` is position");
  if (params.at == BurrHoleRequest::At::kocher && has_position)
    throw Error(code, "", "position_mm", "is not looked at where `at` is kocher");
  if (norm(vector_of(params.direction)) > 0 && !params.toward.empty())
    throw Error(code, "", "direction", "and toward contradict each other, give one of them");
}

std::string missing_landmark(const BurrHoleParams& params, const std::map<std::string, Vec3>& landmarks_mm) {
  const auto known = [&](const std::string& landmark) { return landmarks_mm.count(landmark) > 0; };
  if (params.at == BurrHoleRequest::At::kocher) {
    if (!known("nasion")) return "nasion";
    if (!known("inion") && !known("vertex")) return "inion";
  }
  return params.toward.empty() || known(params.toward) ? "" : params.toward;
}

BurrHoleRequest request_of(const BurrHoleParams& params, const std::string& name,
                           const std::map<std::string, Vec3>& landmarks_mm, ExitCode code) {
  check_request(params, code);
  if (const std::string missing = missing_landmark(params, landmarks_mm); !missing.empty())
    refuse_missing(missing, nullptr, params.min_confidence, code);
  BurrHoleRequest r;
  r.at = params.at;
  r.side = params.side;
  r.name = name;
  r.position_mm = vector_of(params.position_mm);
  r.diameter_mm = params.diameter_mm;
  r.along_mm = params.along_mm;
  r.lateral_mm = params.lateral_mm;
  const Vec3 direction = vector_of(params.direction);
  if (const double length = norm(direction); length > 0) r.direction = direction / length;
  if (!params.toward.empty()) r.toward_mm = landmarks_mm.at(params.toward);
  return r;
}

StageType burr_hole_stage(const std::string& name, std::map<std::string, Vec3> landmarks_mm) {
  StageType s;
  s.name = "burr_hole";
  s.version = 3;
  s.summary = "places a burr hole on a head";
  s.description =
      "At Kocher's point, measured over the skin from landmarks, or at a position; its axis is given, points at a "
      "landmark, or is perpendicular to the skull. The result is the cutter that `boolean` takes, for surfaces and "
      "haptic volumes alike.";
  s.ports = {{"skull", DataKind::mesh, true, "surface of the skull, not decimated"},
             {"skin", DataKind::mesh, false, "surface of the skin, over which Kocher's point is measured"},
             {"landmarks", DataKind::landmarks, false, "found landmarks, given ones among them"}};
  s.output = DataKind::cutters;
  s.make_params = [] { return AnyParams::make<BurrHoleParams>(); };
  s.run = [name, given = std::move(landmarks_mm)](const AnyParams& any, const StageInputs& in, Report& report,
                                                  const Progress&) -> StageData {
    const auto& params = any.as<BurrHoleParams>();
    const HeadLandmarks* found = in.get<HeadLandmarks>("landmarks");
    const auto landmarks = found ? sure(*found, params.min_confidence) : given;
    if (const std::string missing = missing_landmark(params, landmarks); !missing.empty())
      refuse_missing(missing, found, params.min_confidence, ExitCode::quality);
    const BurrHoleRequest request = request_of(params, name, landmarks, ExitCode::bad_config);
    const BurrHole hole =
        place_burr_hole(request, landmarks, in.get<TriMesh>("skin"), *in.get<TriMesh>("skull"), report);
    if (request.at == BurrHoleRequest::At::position) {
      const double moved_mm = norm(hole.position_mm - request.position_mm);
      report.add("entry_from_position_mm", moved_mm);
      if (moved_mm > far_position_mm)
        report.warn("the bone lies " + to_text(ParameterValue(std::round(moved_mm))) + " mm from position_mm");
    }
    // Nothing cuts as far from the frame's origin as a surface can lie.
    with_field(name, [&] { check_cutter(hole.cutter, ExitCode::bad_input); });
    return std::make_shared<const std::vector<Cutter>>(std::vector<Cutter>{hole.cutter});
  };
  return s;
}

}  // namespace trephine
