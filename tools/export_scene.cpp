// SPDX-License-Identifier: GPL-3.0-or-later
#include "export_scene.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/error.h"
#include "base/text.h"
#include "export_parts.h"
#include "export_shapes.h"
#include "meshio/export_format.h"
#include "slicer/scene.h"

namespace trephine::tools {
namespace {

namespace fs = std::filesystem;

constexpr double raster_mm = 1;  ///< of the segmentation of a case without CT

// Where the segmentation lies: on the CT's voxels, so that the two agree to the voxel.
grid::Lattice segmented_lattice(const cases::LoadedCase& loaded, const surface::Bounds& bounds) {
  if (loaded.has_ct()) return loaded.ct;
  grid::Lattice l;
  l.spacing_mm = {raster_mm, raster_mm, raster_mm};
  for (int a = 0; a < 3; ++a) {
    l.origin_mm[a] = std::floor(bounds.min_mm[a] / raster_mm - 1) * raster_mm;
    l.size[std::size_t(a)] = int(std::ceil((bounds.max_mm[a] - l.origin_mm[a]) / raster_mm)) + 2;
  }
  return l;
}

void add_models(const std::vector<ShownShape>& shown, slicer::CaseScene& scene, Report& report,
                const Progress& progress) {
  const meshio::ExportFormat& vtp = meshio::export_format("vtp");
  std::size_t done = 0;
  for (const ShownShape& s : shown) {
    const Progress here = progress.part(double(done) / double(shown.size()), double(done + 1) / double(shown.size()));
    ++done;
    const std::vector<meshio::ExportSurface> one{{s.mesh, s.name, s.colour_rgb, s.opacity, false, s.is_felt}};
    auto files = meshio::encode_surfaces(vtp, one, s.name, here.part(0, 0.5));
    meshio::verify_export(vtp, one, files, here.part(0.5, 1));
    report.add(s.name + ".scene.triangles_count", s.mesh->triangles.size());
    scene.models.push_back({s.name, s.colour_rgb, s.opacity, std::move(files.back().bytes)});
    const surface::Bounds b = surface::bounds_of(*s.mesh);
    for (int a = 0; a < 3; ++a) {
      scene.bounds_mm.min_mm[a] = std::min(scene.bounds_mm.min_mm[a], b.min_mm[a]);
      scene.bounds_mm.max_mm[a] = std::max(scene.bounds_mm.max_mm[a], b.max_mm[a]);
    }
  }
}

void add_segments(const std::vector<ShownShape>& shown, slicer::CaseScene& scene, Report& report,
                  const Progress& progress) {
  const pacs::SliceSet slices = pacs::slices_of(scene.segmented);
  for (const ShownShape& s : shown) {
    pacs::Segment segment{s.name, s.colour_rgb, pacs::bits_inside(*s.mesh, slices, progress)};
    std::size_t voxels = 0;
    for (const std::string& slice : segment.bits)
      for (const char byte : slice) voxels += std::size_t(__builtin_popcount(static_cast<unsigned char>(byte)));
    report.add(s.name + ".scene.voxels_count", voxels);
    if (voxels == 0)
      report.warn(s.name + ": no voxel's middle lies in it, so that it is no segment");
    else
      scene.segments.push_back(std::move(segment));
  }
}

// A hole as long as the bone is thick there, where the case says so.
void add_holes(const cases::CaseManifest& manifest, slicer::CaseScene& scene) {
  for (const cases::CaseBurrHole& h : manifest.burr_holes) {
    const double* thick_mm = nullptr;
    for (const auto& [name, value] : h.figures)
      if (name == "bone_thickness_mm") thick_mm = std::get_if<double>(&value);
    if (!thick_mm || !(*thick_mm > 0)) continue;
    const std::string what = "burr hole of " + to_text(h.diameter_mm) + " mm";
    scene.holes.push_back({{"hole-" + h.name,
                            true,
                            {0.2, 0.6, 0.95},
                            {{h.name + "_outer", what, h.position_mm},
                             {h.name + "_inner", what, h.position_mm + h.direction * *thick_mm}}},
                           h.diameter_mm});
  }
}

}  // namespace

const std::vector<std::string>& scene_format_names() {
  static const std::vector<std::string> names{"slicer-mrb"};
  return names;
}

bool SceneFormats::take(const std::string& name) {
  if (name != "slicer-mrb") return false;
  return slicer_mrb = true;
}

const char* scene_formats_help =
    "Format slicer-mrb is a case as one scene for 3D Slicer (CASE.mrb): its surfaces as models with names, colours and "
    "opacities; a segmentation with SNOMED CT codes and colours, on the CT's voxels (of a case without CT on a raster "
    "of 1 mm); the case's CT, after its face policy; landmarks, targets, trajectories and burr holes as markups; and a "
    "view of them. Files hold LPS and say so; lengths are mm.";

SceneExport export_scenes(const cli::ParsedCommand& parsed, const SceneFormats& formats, const std::string& name,
                          Report& report, const Progress& progress) {
  SceneExport made;
  if (!formats.any()) return made;
  const fs::path folder = parsed.path("input");
  cases::LoadParts parts;
  parts.ct = true;
  const cases::LoadedCase loaded = cases::load_case(folder, parts);
  const cases::CaseManifest& m = loaded.manifest;
  const CaseShapes shapes(loaded, items_of(parsed, "anatomy"), progress.part(0, 0.1));
  if (shapes.all().empty()) throw Error(ExitCode::bad_input, folder.string(), "", "holds no surface");
  slicer::CaseScene scene;
  scene.name = name.empty() ? m.case_token : name;
  scene.program = "trephine " TREPHINE_VERSION;
  add_models(shapes.all(), scene, report, progress.part(0.1, 0.7));
  scene.segmented = segmented_lattice(loaded, scene.bounds_mm);
  add_segments(shapes.all(), scene, report, progress.part(0.7, 0.9));
  if (loaded.has_ct()) {
    scene.ct = loaded.ct;
    scene.ct_nrrd = cases::read_case_file(folder, *m.find_file(m.ct.file));
  }
  scene.markups = meshio::markups_of_case(m, parsed.params<meshio::MarkupsParams>());
  add_holes(m, scene);
  const std::string file = scene.name + ".mrb";
  made.files.push_back({file, slicer::encode_scene(scene)});
  char line[200];
  std::snprintf(line, sizeof line, "%-28s %9.1f   %zu models, %zu segments, %s, %zu markups\n", file.c_str(),
                double(made.files.back().bytes.size()) / 1e6, scene.models.size(), scene.segments.size(),
                loaded.has_ct() ? "the CT" : "no CT", scene.markups.size() + scene.holes.size());
  made.table = line;
  return made;
}

}  // namespace trephine::tools
