// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/error.h"
#include "base/text.h"
#include "meshio/markups.h"

namespace trephine::meshio {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* schema =
    "https://raw.githubusercontent.com/slicer/slicer/master/Modules/Loadable/Markups/Resources/Schema/"
    "markups-schema-v1.0.3.json#";
constexpr double default_trajectory_mm = 60, max_beside_mm = 20;

std::string short_text(double v) { return to_text(std::round(v * 100) / 100 + 0.0); }

/// How far along the hole's axis the nearest target lies, and how far beside it.
struct Aim {
  std::string target;
  double along_mm = 0, beside_mm = 0;
};

std::optional<Aim> aim_of(const cases::CaseBurrHole& hole, const std::vector<cases::CaseTarget>& targets) {
  std::optional<Aim> best;
  for (const cases::CaseTarget& t : targets) {
    const Vec3 to = t.position_mm - hole.position_mm;
    const double along = dot(to, hole.direction), beside = norm(to - hole.direction * along);
    if (along > 1 && beside <= max_beside_mm && (!best || beside < best->beside_mm)) best = Aim{t.name, along, beside};
  }
  return best;
}

Markup trajectory_of(const cases::CaseBurrHole& hole, const cases::CaseManifest& manifest,
                     const MarkupsParams& params) {
  const auto aim = aim_of(hole, manifest.targets);
  const double length = params.trajectory_mm > 0 ? params.trajectory_mm : aim ? aim->along_mm : default_trajectory_mm;
  std::string end = short_text(length) + " mm from the bone's surface";
  if (aim)
    end += "; the axis passes " + aim->target + " at " + short_text(aim->beside_mm) + " mm, " +
           short_text(aim->along_mm) + " mm from the bone's surface";
  return {"trajectory-" + hole.name,
          true,
          {0.95, 0.75, 0.1},
          {{hole.name + "_entry", "burr hole of " + short_text(hole.diameter_mm) + " mm", hole.position_mm},
           {hole.name + "_end", end, hole.position_mm + hole.direction * length}}};
}

Json json_of(const MarkupPoint& point, std::size_t number) {
  return {{"id", std::to_string(number)},
          {"label", point.label},
          {"description", point.description},
          {"associatedNodeID", ""},
          {"position", {point.position_mm.x, point.position_mm.y, point.position_mm.z}},
          {"orientation", {-1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 1.0}},
          {"selected", true},
          {"locked", true},
          {"visibility", true},
          {"positionStatus", "defined"}};
}

}  // namespace

std::vector<Markup> markups_of_case(const cases::CaseManifest& manifest, const MarkupsParams& params) {
  std::vector<Markup> all;
  Markup landmarks{"landmarks", false, {0.2, 0.7, 0.3}, {}}, targets{"targets", false, {0.9, 0.3, 0.2}, {}};
  for (const cases::CaseLandmark& l : manifest.landmarks)
    landmarks.points.push_back({l.name, l.source + ", confidence " + short_text(l.confidence), l.position_mm});
  for (const cases::CaseTarget& t : manifest.targets)
    targets.points.push_back(
        {t.name, (t.anatomy.empty() ? "" : "in " + t.anatomy + ", ") + "confidence " + short_text(t.confidence),
         t.position_mm});
  for (Markup* m : {&landmarks, &targets})
    if (!m->points.empty()) all.push_back(std::move(*m));
  for (const cases::CaseBurrHole& hole : manifest.burr_holes) all.push_back(trajectory_of(hole, manifest, params));
  return all;
}

std::string encode_slicer_markups(const Markup& markup) {
  if (markup.line && markup.points.size() != 2)
    throw Error(ExitCode::internal, "", markup.name, "a line has two points");
  Json points = Json::array();
  for (const MarkupPoint& p : markup.points) points.push_back(json_of(p, points.size() + 1));
  Json m{{"type", markup.line ? "Line" : "Fiducial"},
         {"coordinateSystem", "LPS"},
         {"coordinateUnits", "mm"},
         {"locked", true},
         {"fixedNumberOfControlPoints", markup.line},
         {"labelFormat", "%N-%d"},
         {"lastUsedControlPointNumber", markup.points.size()},
         {"controlPoints", std::move(points)},
         {"measurements", Json::array()},
         {"display", {{"visibility", true}, {"color", markup.colour_rgb}, {"selectedColor", markup.colour_rgb}}}};
  const Json json{{"@schema", schema}, {"markups", Json::array({std::move(m)})}};
  return json.dump(1) + "\n";
}

}  // namespace trephine::meshio
