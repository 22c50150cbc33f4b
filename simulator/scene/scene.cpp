// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/scene.h"

#include <algorithm>
#include <cmath>

#include "surface/bounds.h"
#include "surface/vertex_normals.h"

namespace trephine::scene {
namespace {

void put_mesh(const surface::TriMesh& mesh, Vec3 centre_mm, SceneSurface& out) {
  const std::vector<Vec3> own = mesh.normals.empty() ? surface::vertex_normals(mesh) : std::vector<Vec3>();
  const std::vector<Vec3>& normals = mesh.normals.empty() ? own : mesh.normals;
  out.vertices.resize(mesh.points_mm.size());
  for (std::size_t n = 0; n < out.vertices.size(); ++n) {
    const Vec3 p = mesh.world_mm(n) - centre_mm;
    const Vec3 normal = normalized(normals[n]);
    SceneVertex& v = out.vertices[n];
    for (int a = 0; a < 3; ++a) {
      v.position_mm[a] = float(p[a]);
      v.normal[a] = std::int8_t(std::lround(127 * normal[a]));
    }
    v.normal[3] = 0;
  }
  out.indices.reserve(mesh.triangles.size() * 3);
  for (std::size_t n = 0; n < mesh.triangles.size(); ++n)
    for (const std::uint32_t corner : mesh.triangles[n]) out.indices.push_back(corner);
}

double size_of(const surface::Bounds& b) {
  const Vec3 d = b.max_mm - b.min_mm;
  return std::max(0.0, d.x) * std::max(0.0, d.y) * std::max(0.0, d.z);
}

// The box of the voxels that have a value of the shape; every second voxel of each axis is looked at.
surface::Bounds bounds_of_shape(const voxel::HapticVolume& v, const voxel::HapticShape& s) {
  surface::Bounds b;
  const grid::Grid<std::int16_t>& g = v.voxels;
  grid::Box box{{g.size[0], g.size[1], g.size[2]}, {-1, -1, -1}};
  for (int k = 0; k < g.size[2]; k += 2)
    for (int j = 0; j < g.size[1]; j += 2) {
      const std::int16_t* row = &g.at(0, j, k);
      int first = -1, last = -1;
      for (int i = 0; i < g.size[0]; i += 2)
        if (row[i] >= s.window_low && row[i] <= s.window_high) {
          if (first < 0) first = i;
          last = i;
        }
      if (first < 0) continue;
      const int low[3] = {first, j, k}, high[3] = {last, j, k};
      for (std::size_t a = 0; a < 3; ++a) {
        box.begin[a] = std::min(box.begin[a], low[a]);
        box.end[a] = std::max(box.end[a], high[a]);
      }
    }
  if (box.end[0] < 0) return b;
  for (int corner = 0; corner < 8; ++corner) {
    Vec3 index;
    for (int a = 0; a < 3; ++a)
      index[a] = corner >> a & 1 ? box.end[std::size_t(a)] + 1.5 : box.begin[std::size_t(a)] - 1.5;
    surface::include(b, g.to_world_mm(index));
  }
  return b;
}

std::string last_word(const std::string& name) {
  const auto at = name.rfind('_');
  return at == std::string::npos ? "" : name.substr(at);
}

}  // namespace

int SceneData::find(const std::string& name) const {
  for (std::size_t n = 0; n < surfaces.size(); ++n)
    if (surfaces[n].name == name) return int(n);
  return -1;
}

SceneData scene_of(const cases::LoadedCase& loaded) {
  SceneData scene;
  const cases::CaseManifest& m = loaded.manifest;
  scene.centre_mm = m.center_mm;
  std::vector<std::pair<double, SceneSurface>> found;
  for (std::size_t n = 0; n < m.anatomies.size(); ++n) {
    const cases::CaseAnatomy& a = m.anatomies[n];
    SceneSurface s;
    s.name = a.name;
    s.colour_rgb = a.colour_rgb;
    s.opacity = a.opacity;
    for (const cases::CaseShape& shape : m.haptic.shapes) {
      if (shape.name != a.name) continue;
      s.shape = shape.number;
      s.live = shape.displayed == "haptic" && loaded.has_haptic();
      s.incised = !s.live && shape.cuttable && !(shape.material.removal_energy_j_per_mm3 > 0);
      if (s.live) s.colour_rgb = shape.material.colour_rgb;
    }
    s.skin = s.incised || a.name == "skin";
    surface::Bounds b;
    if (s.live) {
      b = bounds_of_shape(loaded.haptic, *loaded.haptic.find_shape(a.name));
    } else {
      if (loaded.surfaces[n].triangles.empty()) continue;
      b = surface::bounds_of(loaded.surfaces[n]);
      put_mesh(loaded.surfaces[n], scene.centre_mm, s);
    }
    if (b.min_mm.x > b.max_mm.x) continue;  // a shape without a voxel
    surface::include(scene.bounds, b);
    found.emplace_back(size_of(b), std::move(s));
  }
  // Shapes that are felt and no anatomy of the case.
  for (const cases::CaseShape& shape : m.haptic.shapes) {
    if (m.find_anatomy(shape.name) || shape.displayed != "haptic" || !loaded.has_haptic()) continue;
    SceneSurface s;
    s.name = shape.name;
    s.colour_rgb = shape.material.colour_rgb;
    s.shape = shape.number;
    s.live = true;
    const surface::Bounds b = bounds_of_shape(loaded.haptic, *loaded.haptic.find_shape(shape.name));
    if (b.min_mm.x > b.max_mm.x) continue;
    surface::include(scene.bounds, b);
    found.emplace_back(size_of(b), std::move(s));
  }
  std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  for (auto& f : found) scene.surfaces.push_back(std::move(f.second));
  if (scene.surfaces.empty()) scene.bounds = {scene.centre_mm - Vec3{1, 1, 1}, scene.centre_mm + Vec3{1, 1, 1}};
  return scene;
}

std::optional<Approach> approach_of(const cases::CaseManifest& m, const SceneData& scene, const std::string& site) {
  for (const cases::CaseBurrHole& b : m.burr_holes)
    if (b.name == site) return Approach{b.position_mm, normalized(b.direction)};
  for (const cases::CaseLandmark& l : m.landmarks) {
    if (l.name != site) continue;
    Vec3 to = scene.centre_mm;
    const std::string side = last_word(site);
    double best = 1e300;
    for (const cases::CaseTarget& t : m.targets) {
      const double away = norm(t.position_mm - l.position_mm) + (last_word(t.name) == side ? 0 : 1e6);
      if (away >= best) continue;
      best = away;
      to = t.position_mm;
    }
    if (norm(to - l.position_mm) > 0) return Approach{l.position_mm, normalized(to - l.position_mm)};
  }
  return std::nullopt;
}

}  // namespace trephine::scene
