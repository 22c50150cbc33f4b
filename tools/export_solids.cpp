// SPDX-License-Identifier: GPL-3.0-or-later
#include "export_solids.h"

#include <algorithm>
#include <cstdio>
#include <memory>

#include "base/error.h"
#include "base/result.h"
#include "base/write_file.h"
#include "case_shapes.h"
#include "meshio/sdf_model.h"
#include "tetra/tetra_mesh.h"

namespace trephine::tools {
namespace {

namespace fs = std::filesystem;

// The wanted anatomies of a case, or the surfaces of the input.
struct Solids {
  cases::LoadedCase loaded;
  std::unique_ptr<CaseShapes> shapes;
  std::vector<meshio::ExportSurface> all;
};

void load(const cli::ParsedCommand& parsed, const ExportInput& input, Solids& solids, const Progress& progress) {
  const fs::path path = parsed.path("input");
  if (!fs::is_directory(path)) {
    solids.all = input.surfaces;
    return;
  }
  solids.loaded = cases::load_case(path);
  solids.shapes = std::make_unique<CaseShapes>(solids.loaded, items_of(parsed, "anatomy"), progress);
  for (const ShownShape& s : solids.shapes->all())
    solids.all.push_back({s.mesh, s.name, s.colour_rgb, s.opacity, false});
}

template <class... Values>
std::string line_of(const char* form, Values... values) {
  char line[200];
  std::snprintf(line, sizeof line, form, values...);
  return line;
}

void add_tetra(const Solids& solids, const SolidFormats& formats, const tetra::TetraParams& params,
               const std::string& stem, SolidExport& made, Report& report, const Progress& progress) {
  std::vector<tetra::NamedSurface> surfaces;
  for (const meshio::ExportSurface& s : solids.all) surfaces.push_back({s.name, s.mesh});
  const auto filled = tetra::fill_with_tetrahedra(surfaces, params, progress);
  const tetra::TetraResult& r = filled.result;
  for (const auto& [name, value] : figures_of(r)) report.figures.emplace_back("tetra." + name, value);
  made.table += line_of("%zu tetrahedra and %zu triangles of borders on %zu points\n", r.tetrahedra_count,
                        r.borders_count, r.points_count);
  made.table += line_of(
      "angles between faces %.1f to %.1f degrees, 99 %% have none below %.1f; radius ratio at least "
      "%.3f, median %.3f\n",
      r.quality.dihedral_min_deg, r.quality.dihedral_max_deg, r.quality.dihedral_p1_deg, r.quality.ratio_min,
      r.quality.ratio_median);
  made.table +=
      "region              tetrahedra   volume, ml   counted, ml   off the surface, mm: rms    99 %   largest\n";
  for (const auto& [name, region] : r.regions)
    made.table += line_of("%-18s %11zu %12.2f %13.2f %28.3f %7.3f %9.3f\n", name.c_str(), region.tetrahedra_count,
                          region.volume_ml, region.counted_volume_ml, region.deviation_rms_mm, region.deviation_p99_mm,
                          region.deviation_max_mm);
  if (formats.vtu) made.files.push_back({stem + ".vtu", tetra::encode_vtu(filled.value)});
  if (formats.msh) made.files.push_back({stem + ".msh", tetra::encode_msh(filled.value)});
}

void add_sdf(const Solids& solids, const meshio::SdfParams& params, const std::string& stem, SolidExport& made,
             Report& report, const Progress& progress) {
  auto model = meshio::sdf_model(solids.all, stem, params, progress);
  for (const auto& [name, value] : figures_of(model.result)) report.figures.emplace_back("sdf." + name, value);
  made.table += line_of("%s: %.3f kg about (%.4f, %.4f, %.4f) m\n", stem.c_str(), model.result.mass_kg,
                        model.result.centre_m[0], model.result.centre_m[1], model.result.centre_m[2]);
  made.table += "collision           triangles   off by at most, mm\n";
  for (const auto& [name, c] : model.result.collisions)
    made.table += line_of("%-18s %10zu %20.3f\n", name.c_str(), c.triangles_count, c.deviation_max_mm);
  made.folder = stem;
  made.model = std::move(model.value);
}

}  // namespace

const std::vector<std::string>& solid_format_names() {
  static const std::vector<std::string> names{"tetra-vtu", "tetra-msh", "sdf"};
  return names;
}

bool SolidFormats::take(const std::string& name) {
  bool* const members[] = {&vtu, &msh, &sdf};
  const auto& names = solid_format_names();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) return false;
  *members[found - names.begin()] = true;
  return true;
}

const char* solid_formats_help =
    "For those who compute: tetra-vtu (VTK) and tetra-msh (Gmsh 2.2) fill all anatomies together with tetrahedra, in "
    "one "
    "file. A place belongs to the smallest surface that holds it; regions that meet share the points and triangles of "
    "their border, which are in the file too. Each tetrahedron "
    "has the region's number, and the file its name; quality, volumes and the distance from the case's surfaces are "
    "printed. "
    "They need trephine-tetra. sdf is a model for Gazebo (a folder with model.sdf, model.config and meshes): metres, x "
    "to the "
    "front, y to the left, z upwards, with mass and inertia, and simpler surfaces for collisions.";

std::vector<cli::ParameterGroup> solid_groups() {
  return {cli::ParameterGroup::of<tetra::TetraParams>("Tetrahedra"),
          cli::ParameterGroup::of<meshio::SdfParams>("Model for robots' simulators")};
}

SolidExport export_solids(const cli::ParsedCommand& parsed, const SolidFormats& formats, const ExportInput& input,
                          const std::string& stem, Report& report, const Progress& progress) {
  Solids solids;
  load(parsed, input, solids, progress.part(0, 0.1));
  if (solids.all.empty()) throw Error(ExitCode::bad_input, parsed.text("input"), "", "holds no surface");
  SolidExport made;
  if (formats.tetra())
    add_tetra(solids, formats, parsed.params<tetra::TetraParams>(), stem, made, report, progress.part(0.1, 0.7));
  if (formats.sdf) add_sdf(solids, parsed.params<meshio::SdfParams>(), stem, made, report, progress.part(0.7, 1));
  return made;
}

void write_solids(const fs::path& out, const SolidExport& made) {
  meshio::write_export(out, made.files);
  if (made.model.empty()) return;
  make_output_folder(out / made.folder);
  meshio::write_export(out / made.folder, made.model);
}

}  // namespace trephine::tools
