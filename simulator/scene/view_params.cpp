// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/view_params.h"

#include <algorithm>
#include <cstdlib>

#include "base/error.h"
#include "base/joined.h"

namespace trephine::scene {

namespace {

std::vector<double> with_named(std::vector<double> all, const SceneData& scene, const std::string& text) {
  const auto refuse = [](const std::string& item, const std::string& what) {
    throw Error(ExitCode::usage, "", "--opacity", item + ": " + what);
  };
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(',', at), text.size());
    const std::string item = text.substr(at, end - at);
    at = end + 1;
    const std::size_t equals = item.find('=');
    if (equals == std::string::npos) refuse(item, "must be NAME=NUMBER");
    const int n = scene.find(item.substr(0, equals));
    if (n < 0) {
      const std::string names = joined(scene.surfaces, ", ", &SceneSurface::name);
      refuse(item, "the case shows " + (names.empty() ? "nothing" : names));
    }
    char* rest = nullptr;
    const std::string number = item.substr(equals + 1);
    const double value = std::strtod(number.c_str(), &rest);
    if (number.empty() || *rest != 0 || !(value >= 0 && value <= 1)) refuse(item, "must be a number from 0 to 1");
    all[std::size_t(n)] = value;
  }
  return all;
}

}  // namespace

std::vector<double> opacities_of(const SceneData& scene, const std::string& text) {
  std::vector<double> own;
  for (const SceneSurface& s : scene.surfaces) own.push_back(s.opacity);
  return with_named(std::move(own), scene, text);
}

std::vector<double> opacities_beside_rays(const SceneData& scene, const std::string& text, bool of_shapes) {
  std::vector<double> all;
  for (const SceneSurface& s : scene.surfaces) all.push_back(of_shapes && s.shape != 0 ? 1 : 0);
  return with_named(std::move(all), scene, text);
}

std::optional<CutPlane> cut_of(const ViewParams& params, const SceneData& scene) {
  Vec3 normal;
  switch (params.cut) {
    case ViewParams::Cut::none:
      return std::nullopt;
    case ViewParams::Cut::axial:
      normal = {0, 0, 1};
      break;
    case ViewParams::Cut::coronal:
      normal = {0, -1, 0};
      break;
    case ViewParams::Cut::sagittal:
      normal = {1, 0, 0};
      break;
  }
  const Vec3 middle = (scene.bounds.min_mm + scene.bounds.max_mm) / 2;
  return CutPlane{middle + normal * params.cut_mm, normal};
}

std::optional<surface::Bounds> cast_box_of(const ViewParams& params, const SceneData& scene) {
  const ViewParams whole;
  if (params.box_low_mm == whole.box_low_mm && params.box_high_mm == whole.box_high_mm) return std::nullopt;
  const Vec3 middle = (scene.bounds.min_mm + scene.bounds.max_mm) / 2;
  const auto &low = params.box_low_mm, &high = params.box_high_mm;
  return surface::Bounds{middle + Vec3{low[0], low[1], low[2]}, middle + Vec3{high[0], high[1], high[2]}};
}

std::vector<Marker> places_of(const cases::CaseManifest& m) {
  std::vector<Marker> all;
  for (const cases::CaseLandmark& l : m.landmarks)  // what a procedure aims at is shown once, as the target
    if (std::none_of(m.targets.begin(), m.targets.end(), [&](const cases::CaseTarget& t) { return t.name == l.name; }))
      all.push_back({l.position_mm, 1.3, {0.98f, 0.72f, 0.10f}});
  for (const cases::CaseBurrHole& b : m.burr_holes) all.push_back({b.position_mm, 1.3, {0.20f, 0.75f, 0.45f}});
  for (const cases::CaseTarget& t : m.targets) all.push_back({t.position_mm, 2, {0.20f, 0.55f, 0.95f}});
  return all;
}

std::vector<Marker> moving_of(const session::MovingTarget* target, double time_s) {
  if (!target) return {};
  return {{target->first_mm(), 2, {0.1f, 0.75f, 0.35f}}, {target->at_mm(time_s), 3, {0.9f, 0.15f, 0.1f}}};
}

OrbitCamera camera_of(const ViewParams& params, const cases::CaseManifest& manifest, const SceneData& scene) {
  OrbitCamera camera;
  camera.field_of_view_deg = params.field_of_view_deg;
  const std::optional<Approach> a = approach_of(manifest, scene, params.view_site);
  camera.look(params.view, scene.bounds, a ? std::optional<Vec3>(a->site_mm) : std::nullopt, a ? a->direction : Vec3{});
  return camera;
}

}  // namespace trephine::scene
