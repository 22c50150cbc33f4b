// SPDX-License-Identifier: GPL-3.0-or-later
#include "export_scene.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "ambf/adf.h"
#include "base/error.h"
#include "base/text.h"
#include "base/write_file.h"
#include "case_shapes.h"
#include "export_parts.h"
#include "meshio/export_format.h"
#include "slicer/scene.h"

namespace trephine::tools {
namespace {

namespace fs = std::filesystem;

constexpr double raster_mm = 1;  ///< of the segmentation of a case without CT
constexpr const char* program = "trephine " TREPHINE_VERSION;

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

void add_slicer_scene(const cli::ParsedCommand& parsed, const cases::LoadedCase& loaded, const std::string& name,
                      SceneExport& made, Report& report, const Progress& progress) {
  const CaseShapes shapes(loaded, items_of(parsed, "anatomy"), progress.part(0, 0.1));
  if (shapes.all().empty()) throw Error(ExitCode::bad_input, parsed.text("input"), "", "holds no surface");
  slicer::CaseScene scene;
  scene.name = name;
  scene.program = program;
  add_models(shapes.all(), scene, report, progress.part(0.1, 0.7));
  scene.segmented = segmented_lattice(loaded, scene.bounds_mm);
  add_segments(shapes.all(), scene, report, progress.part(0.7, 1));
  if (loaded.has_ct()) {
    scene.ct = loaded.ct;
    scene.ct_nrrd = cases::read_case_file(parsed.path("input"), *loaded.manifest.find_file(loaded.manifest.ct.file));
  }
  scene.markups = meshio::markups_of_case(loaded.manifest, parsed.params<meshio::MarkupsParams>());
  add_holes(loaded.manifest, scene);
  const std::string file = name + ".mrb";
  made.files.push_back({file, slicer::encode_scene(scene)});
  char line[200];
  std::snprintf(line, sizeof line, "%-28s %9.1f   %zu models, %zu segments, %s, %zu markups\n", file.c_str(),
                double(made.files.back().bytes.size()) / 1e6, scene.models.size(), scene.segments.size(),
                loaded.has_ct() ? "the CT" : "no CT", scene.markups.size() + scene.holes.size());
  made.table += line;
}

void add_ambf(const cli::ParsedCommand& parsed, const cases::LoadedCase& loaded, const std::string& name,
              SceneExport& made, Report& report) {
  made.of_ambf = with_file(parsed.text("input"),
                           [&] { return ambf::encode_adf(loaded, parsed.params<ambf::AdfParams>(), program); });
  made.ambf_folder = name + ".ambf";
  std::size_t bytes = 0;
  for (const meshio::ExportFile& f : made.of_ambf) bytes += f.bytes.size();
  const auto& size = loaded.haptic.voxels.size;
  report.add(made.ambf_folder + ".pictures_count", size[2]);
  char line[200];
  std::snprintf(line, sizeof line, "%-28s %9.1f   %d pictures of %d x %d\n", made.ambf_folder.c_str(),
                double(bytes) / 1e6, size[2], size[0], size[1]);
  made.table += line;
}

}  // namespace

const std::vector<std::string>& scene_format_names() {
  static const std::vector<std::string> names{"slicer-mrb", "ambf"};
  return names;
}

bool SceneFormats::take(const std::string& name) {
  if (name == "slicer-mrb") return slicer_mrb = true;
  if (name == "ambf") return ambf = true;
  return false;
}

const char* scene_formats_help =
    "Format slicer-mrb is a case as one scene for 3D Slicer (CASE.mrb): its surfaces as models with names, colours and "
    "opacities; a segmentation with SNOMED CT codes and colours, on the CT's voxels (of a case without CT on a raster "
    "of 1 mm); the case's CT, after its face policy; landmarks, targets, trajectories and burr holes as markups; and a "
    "view of them. Files hold LPS and say so; lengths are mm.\n\n"
    "Format ambf is a case for AMBF with volumetric_drilling: a folder CASE.ambf, for that project's folder ADF, with "
    "the haptic volume as a stack of pictures, the patient's frame, camera, burrs, landmarks, targets and burr holes, "
    "in metres. `trephine drilled` reads back what was drilled there.";

SceneExport export_scenes(const cli::ParsedCommand& parsed, const SceneFormats& formats, const std::string& name,
                          Report& report, const Progress& progress) {
  SceneExport made;
  if (!formats.any()) return made;
  if (formats.ambf && parsed.has("anatomy"))
    export_usage("--anatomy", "chooses surfaces, and --format ambf holds the whole haptic volume: leave it out");
  cases::LoadParts parts;
  parts.ct = formats.slicer_mrb;
  const cases::LoadedCase loaded = cases::load_case(parsed.path("input"), parts);
  const std::string& stem = name.empty() ? loaded.manifest.case_token : name;
  if (formats.slicer_mrb) add_slicer_scene(parsed, loaded, stem, made, report, progress);
  if (formats.ambf) add_ambf(parsed, loaded, stem, made, report);
  return made;
}

void write_scenes(const fs::path& out, const SceneExport& made) {
  meshio::write_export(out, made.files);
  if (made.of_ambf.empty()) return;
  std::map<fs::path, std::vector<meshio::ExportFile>> folders;
  for (const meshio::ExportFile& f : made.of_ambf) {
    const fs::path name(f.name);
    folders[name.parent_path()].push_back({name.filename().string(), f.bytes});
  }
  const fs::path scene = out / made.ambf_folder;
  std::error_code ignored;
  // Without its launch file there is no scene, so what is written above an older one is never taken for a whole one.
  fs::remove(scene / "launch.yaml", ignored);
  for (auto it = folders.rbegin(); it != folders.rend(); ++it) {  // the scene's own folder is the first, and comes last
    make_output_folder(scene / it->first);
    meshio::write_export(scene / it->first, it->second);
  }
  for (std::size_t n = folders[ambf::stack_folder].size();
       fs::remove(scene / ambf::stack_folder / ambf::picture_name(n), ignored); ++n) {
  }
}

}  // namespace trephine::tools
