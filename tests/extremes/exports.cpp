// SPDX-License-Identifier: GPL-3.0-or-later
// What the formats of other programs hold of a surface: float32 rounding far from the frame's origin, and what must not
// be written at all. Every file is read back by another program's reader.
#include <cmath>

#include "base/text.h"
#include "meshio/export_format.h"
#include "outcome.h"
#include "scenes.h"

namespace trephine::extremes {
namespace {

std::string exported(const meshio::ExportFormat& format, const surface::TriMesh& mesh) {
  const std::vector<meshio::ExportSurface> surfaces{{&mesh, "outer"}};
  const auto files = meshio::encode_surfaces(format, surfaces, "outer");
  const meshio::ExportCheck check = meshio::verify_export(format, surfaces, files);
  if (check.triangles != mesh.triangles.size()) return "FAULT: triangles are lost";
  const double off = check.largest_difference_mm;
  return grouped_text(static_cast<long long>(check.triangles)) + " triangles, read by " + check.read_by + ", " +
         (off < 1e-4 ? "less than 0.0001" : rounded(std::ceil(off * 1e3) / 1e3)) + " mm off";
}

std::vector<Case> cases_of(const meshio::ExportFormat& format) {
  std::vector<Case> cases;
  const auto add = [&](const std::string& extreme, const std::function<surface::TriMesh()>& make) {
    cases.push_back({std::string(format.name) + ": " + extreme, [&format, make] { return exported(format, make()); }});
  };
  const auto of_scene = [&](const std::string& name) {
    for (const ExtremeScene& e : extreme_scenes(Body::balls))
      if (e.name == name) add(name, [&e] { return e.scene().meshes.at(""); });
  };
  for (const char* name : {"2 x 2 x 2 voxels", "voxels of 0.05 mm", "voxels of 10 mm", "1 km from the frame's origin",
                           "a voxel and a point that are NaN", "a voxel and a point that are infinite"})
    of_scene(name);
  add("voxels of 0.05 mm, 1 km from the frame's origin, where float32 has steps of 0.06 mm", [] {
    surface::TriMesh mesh = scene_of("", cube({32, 32, 32}, {0.05, 0.05, 0.05}), balls(0.6, {})).meshes.at("");
    for (Vec3& p : mesh.points_mm) p = p + Vec3{6e5, -6.4e5, 4.8e5};
    return mesh;
  });
  add("no triangle", [] { return surface::TriMesh(); });
  return cases;
}

}  // namespace

std::vector<Section> export_sections() {
  return {{"export", "Export", "", [] {
             std::vector<Case> all;
             for (const meshio::ExportFormat& format : meshio::format_types())
               for (Case& c : cases_of(format)) all.push_back(std::move(c));
             return all;
           }}};
}

}  // namespace trephine::extremes
