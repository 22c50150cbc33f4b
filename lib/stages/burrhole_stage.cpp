// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/refusal.h"
#include "boolean/burr_hole.h"
#include "boolean/burr_hole_params.h"
#include "boolean/zone_clearance.h"
#include "craniometry/plausible.h"
#include "stages/stage.h"

namespace trephine::stages {
namespace {

struct PlacedHoleResult {
  boolean::BurrHoleResult hole;
  std::optional<double> before_suture_mm;  ///< Kocher's point, where the suture is seen
  Named<double> clear_of_mm;               ///< how far the trajectory keeps from a zone
  std::optional<double> entry_from_position_mm;
  template <class V>
  static void describe(V& v) {
    using P = PlacedHoleResult;
    v.all_of(&P::hole);
    v.number(&P::before_suture_mm, "before_suture_mm", "How far Kocher's point lies before the coronal suture.");
    v.map(&P::clear_of_mm, "clear_of", "How far the trajectory keeps from a zone.").items_between("clear_of_", "_mm");
    v.number(&P::entry_from_position_mm, "entry_from_position_mm", "How far the entry lies from the position asked.");
  }
};
using Placed = Outcome<std::vector<boolean::Cutter>, PlacedHoleResult>;

// The landmarks with at least this confidence, by name.
std::map<std::string, Vec3> sure(const head::HeadLandmarks& known, double min_confidence) {
  std::map<std::string, Vec3> out;
  for (const cases::CaseLandmark& l : known.landmarks)
    if (l.confidence >= min_confidence) out[l.name] = l.position_mm;
  return out;
}

bool were_looked_for(const head::HeadLandmarks* known) {
  return known && std::any_of(known->landmarks.begin(), known->landmarks.end(),
                              [](const cases::CaseLandmark& l) { return l.source != "given"; });
}

[[noreturn]] void refuse_missing(const std::string& name, const head::HeadLandmarks* known, double min_confidence) {
  const cases::CaseLandmark* unsure = known ? known->find(name) : nullptr;
  const auto text = [](double v) { return trephine::to_text(ParameterValue(std::round(v * 100) / 100)); };
  throw refusal("landmarks." + name,
                unsure ? "has a confidence of " + text(unsure->confidence) + ", below " + text(min_confidence)
                : were_looked_for(known) ? "was not found"
                                         : "is missing",
                {boolean::how_to_give_a_landmark});
}

/// The bregma where it is sure, or the suture is seen on both sides of a midline at which it has grown together: to
/// some mm it then lies there, which is enough to refuse what lies far off.
const Vec3* seen_bregma(const std::map<std::string, Vec3>& landmarks, const head::HeadLandmarks* known) {
  if (const auto sure = landmarks.find("bregma"); sure != landmarks.end()) return &sure->second;
  const cases::CaseLandmark* l = known ? known->find("bregma") : nullptr;
  return l && l->source == "found" && l->confidence >= head::seen_bregma_confidence ? &l->position_mm : nullptr;
}

/// Kocher's point has its place before the coronal suture, whatever the arcs say. A bregma that is not seen is no
/// suture.
void check_suture(const boolean::BurrHoleParams& params, const boolean::BurrHole& hole,
                  const std::map<std::string, Vec3>& landmarks, const head::HeadLandmarks* known, Placed& placed) {
  const Vec3* bregma = seen_bregma(landmarks, known);
  if (!bregma) {
    if (were_looked_for(known))
      placed.warnings.push_back(
          {"suture_not_seen",
           "the coronal suture was not seen: how far before it Kocher's point lies was not checked; give its "
           "bregma, or look at the pictures",
           {}});
    return;
  }
  const Vec3 nasion = landmarks.at("nasion");
  const auto inion = landmarks.find("inion");
  const Vec3 back = inion != landmarks.end() ? inion->second : landmarks.at("vertex");
  // The middle between nasion and inion; under the vertex it lies as far below the bregma.
  const Vec3 middle = (nasion + back) * 0.5;
  const Vec3 centre = inion != landmarks.end() ? middle : middle + normalized(middle - *bregma) * 60;
  const double before_mm = craniometry::before_suture_mm(hole.position_mm, *bregma, centre, nasion);
  placed.result.before_suture_mm = before_mm;
  if (before_mm >= params.min_before_suture_mm && before_mm <= params.max_before_suture_mm) return;
  const double right_mm = 0.5 * (params.min_before_suture_mm + params.max_before_suture_mm);
  throw refusal(
      "along_mm",
      fmt::format("Kocher's point lies {:.0f} mm {} the coronal suture, {:.0f} to {:.0f} mm before it are allowed",
                  std::abs(before_mm), before_mm < 0 ? "behind" : "before", params.min_before_suture_mm,
                  params.max_before_suture_mm),
      {Message(Setting{"along_mm",
                       fmt::format("{:.0f}", std::clamp(params.along_mm + before_mm - right_mm, 10.0, 250.0))}) +
       " puts it there; or, where nasion or bregma are wrong in the pictures, give them in the case's configuration, "
       "in mm, LPS: `landmarks: {nasion: [x, y, z], bregma: [x, y, z]}`, or a `landmarks_file` (.mrk.json or .fcsv of "
       "3D Slicer)"});
}

/// Refuses a trajectory that comes too near to a zone.
void check_zones(const boolean::BurrHoleParams& params, const boolean::BurrHole& hole, const StageInputs& in,
                 Placed& placed) {
  const auto zones = in.all<surface::TriMesh>("zone");
  for (const auto& [name, said] : params.avoid) {
    const auto zone = zones.find(name);
    if (zone == zones.end())
      throw Error(ExitCode::usage, "", "avoid", name + ", no zone of that name is given: --zone " + name + "=FILE");
    const boolean::ZoneClearance found = boolean::clearance_of(hole, hole.request.toward_mm, *zone->second);
    placed.result.clear_of_mm.emplace_back(name, found.least_mm);
    if (found.least_mm >= said.clear_mm) continue;
    throw refusal(
        "avoid." + name,
        fmt::format("the trajectory {} {} at {:.0f}, {:.0f}, {:.0f} mm (LPS), {:g} mm are asked for",
                    found.least_mm < 0 ? fmt::format("enters the zone by {:.1f} mm:", -found.least_mm)
                                       : fmt::format("comes as near as {:.1f} mm to", found.least_mm),
                    name, found.at_mm.x, found.at_mm.y, found.at_mm.z, said.clear_mm),
        {"move the hole (`lateral_mm`, `along_mm`, `side`, or `position_mm`), aim elsewhere (`toward`), or ask for "
         "less in `avoid`"});
  }
}

std::vector<std::string> avoided(const AnyParams& any) {
  std::vector<std::string> names;
  for (const auto& zone : any.as<boolean::BurrHoleParams>().avoid) names.push_back(zone.first);
  return names;
}

}  // namespace

StageType burrhole_stage() {
  StageType s;
  s.name = "burrhole";
  s.version = 9;
  s.place = StagePlace::scene;
  s.summary = "places a burr hole on a head";
  s.description =
      "The hole is placed at Kocher's point, measured over the skin from landmarks, or at a position. Kocher's point "
      "is refused where it does not lie 5 to 25 mm before the coronal suture, as far as that is seen; a position is "
      "checked for bone and direction alone. The hole's axis is "
      "given, points at a landmark, or is perpendicular to the skull. Where `avoid` names zones, a trajectory that "
      "comes nearer to one than it says is refused. The result is the cutter that `boolean` takes, "
      "for surfaces and for haptic volumes.";
  s.examples = {
      "trephine burrhole skull.vtp --over skin.vtp --landmark nasion=0,-95,10 --landmark inion=0,98,0 --output "
      "hole.json",
      "trephine burrhole skull.vtp --at position --position-mm -30,-40,70 --diameter-mm 12 --output hole.json"};
  s.ports = {port("bone", DataKind::mesh).of_role("burr_holes.bone").help("surface of the bone, not decimated"),
             port("over", DataKind::mesh)
                 .of_role("burr_holes.over")
                 .optional()
                 .help("surface of the skin, over which Kocher's point is measured"),
             port("landmarks", DataKind::landmarks)
                 .from(From::known_landmarks)
                 .optional()
                 .help("landmarks, found and given ones"),
             port("zone.*", DataKind::mesh).of(avoided).optional().help("zones that `avoid` names")};
  s.output = DataKind::cutters;
  s.declares<boolean::BurrHoleParams, PlacedHoleResult>();
  s.run = [](const AnyParams& any, const StageInputs& in, const Progress&) {
    const auto& params = any.as<boolean::BurrHoleParams>();
    const head::HeadLandmarks* known = in.get<head::HeadLandmarks>("landmarks");
    const auto landmarks = known ? sure(*known, params.min_confidence) : std::map<std::string, Vec3>();
    if (const std::string missing = boolean::missing_landmark(params, landmarks); !missing.empty())
      refuse_missing(missing, known, params.min_confidence);
    const boolean::BurrHoleRequest request = boolean::request_of(params, landmarks, ExitCode::bad_config);
    const auto made = boolean::place_burr_hole(request, landmarks, in.get<surface::TriMesh>("over"),
                                               *in.get<surface::TriMesh>("bone"));
    const boolean::BurrHole& hole = made.value;
    Placed placed{{hole.cutter}, {made.result, {}, {}, {}}, made.warnings};
    if (request.at == boolean::BurrHoleRequest::At::kocher) check_suture(params, hole, landmarks, known, placed);
    check_zones(params, hole, in, placed);
    if (request.at == boolean::BurrHoleRequest::At::position)
      placed.result.entry_from_position_mm = norm(hole.position_mm - request.position_mm);
    // Checks that the cutter lies no further from the frame's origin than a surface can lie.
    with_field(params.name, [&] { boolean::check_cutter(hole.cutter, ExitCode::bad_input); });
    return stage_outcome(std::move(placed));
  };
  return s;
}

}  // namespace trephine::stages
