// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/error.h"
#include "boolean/cut_surface.h"
#include "boolean/cutter_use.h"
#include "cli/command.h"
#include "grid/bounded_read.h"
#include "meshio/read_mesh.h"
#include "named_values.h"
#include "stage_command.h"
#include "stages/data_files.h"
#include "voxel/cut.h"
#include "voxel/haptic_file.h"

namespace trephine::tools {
namespace {

enum class CutterKind { none, cylinder, cone, ellipsoid, sphere };

struct CutterParams {
  CutterKind kind = CutterKind::none;
  std::array<double, 3> position_mm{0, 0, 0};
  std::array<double, 3> direction{0, 0, -1}, across{1, 0, 0};
  double radius_mm = boolean::Cutter().radius_mm, end_radius_mm = boolean::Cutter().end_radius_mm;
  std::array<double, 3> radii_mm = boolean::Cutter().radii_mm;
  double above_mm = boolean::Cutter().above_mm, depth_mm = boolean::Cutter().depth_mm;

  template <class V>
  static void describe(V& v) {
    using P = CutterParams;
    v.choice(&P::kind, "kind",
             {{"none", CutterKind::none},
              {"cylinder", CutterKind::cylinder},
              {"cone", CutterKind::cone},
              {"ellipsoid", CutterKind::ellipsoid},
              {"sphere", CutterKind::sphere}},
             "Makes one cutter from the values below, in addition to those of --cutters.");
    v.numbers(&P::position_mm, "position_mm", Range{-1e5, 1e5},
              "Cylinder and cone: the entry point on the axis; sphere and ellipsoid: the centre; LPS.");
    v.numbers(&P::direction, "direction", Range{-1e5, 1e5},
              "Axis, pointing into the body; for an ellipsoid its third axis.");
    v.numbers(&P::across, "across", Range{-1e5, 1e5}, "First axis of an ellipsoid.");
    v.number(&P::radius_mm, "radius_mm", Range{0.01, 1000},
             "Radius of a cylinder or sphere; for a cone the radius at the entry.");
    v.number(&P::end_radius_mm, "end_radius_mm", Range{0, 1000}, "Radius of a cone at its far end.");
    v.numbers(&P::radii_mm, "radii_mm", Range{0.01, 1000}, "Ellipsoid.");
    v.number(&P::above_mm, "above_mm", Range{0, 1000}, "How far a cylinder or cone reaches outwards from the entry.");
    v.number(&P::depth_mm, "depth_mm", Range{0, 1000}, "How far a cylinder or cone reaches inwards from the entry.");
  }
};

Vec3 vec(const std::array<double, 3>& a) { return {a[0], a[1], a[2]}; }

Vec3 unit(const std::array<double, 3>& a, const char* flag) {
  const Vec3 v = vec(a);
  if (!(norm(v) > 0)) throw Error(ExitCode::usage, "", flag, "0,0,0, must have a length");
  return normalized(v);
}

boolean::Cutter cutter_of(const CutterParams& p) {
  boolean::Cutter c;
  c.name = "cutter";
  c.kind = p.kind == CutterKind::cylinder    ? boolean::Cutter::Kind::cylinder
           : p.kind == CutterKind::cone      ? boolean::Cutter::Kind::cone
           : p.kind == CutterKind::ellipsoid ? boolean::Cutter::Kind::ellipsoid
                                             : boolean::Cutter::Kind::sphere;
  c.position_mm = vec(p.position_mm);
  c.direction = unit(p.direction, "--direction");
  // The ellipsoid's first axis is made perpendicular to its third.
  const Vec3 across = unit(p.across, "--across");
  c.across = normalized(across - c.direction * dot(across, c.direction));
  if (c.kind == boolean::Cutter::Kind::ellipsoid && !(norm(c.across) > 0.5))
    throw Error(ExitCode::usage, "", "--across", "must not be parallel to --direction");
  c.radius_mm = p.radius_mm;
  c.end_radius_mm = p.end_radius_mm;
  c.radii_mm = p.radii_mm;
  c.above_mm = p.above_mm;
  c.depth_mm = p.depth_mm;
  boolean::check_cutter(c, ExitCode::usage);
  return c;
}

std::vector<boolean::Cutter> cutters_given(const cli::ParsedCommand& parsed) {
  std::vector<boolean::Cutter> all;
  const auto& params = parsed.params<CutterParams>();
  if (params.kind != CutterKind::none) all.push_back(cutter_of(params));
  for (const std::string& file : parsed.all("cutters")) {
    const stages::StageData data = stages::load_data(file, stages::DataKind::cutters);
    const auto& more = *std::get<std::shared_ptr<const std::vector<boolean::Cutter>>>(data);
    all.insert(all.end(), more.begin(), more.end());
  }
  for (const std::string& file : parsed.all("cutter_mesh")) {
    boolean::Cutter c;
    c.kind = boolean::Cutter::Kind::mesh;
    c.name = "mesh_" + std::to_string(all.size() + 1);
    c.mesh = std::make_shared<const surface::TriMesh>(meshio::read_mesh_file(file).value);
    with_file(file, [&] { boolean::check_cutter(c, ExitCode::bad_input); });
    all.push_back(std::move(c));
  }
  if (all.empty())
    throw Error(ExitCode::usage, "", "--cutters, --cutter-mesh, --kind", "nothing to cut with: give one of them");
  return boolean::with_unique_names(std::move(all));
}

Report cut_surface_file(const cli::ParsedCommand& parsed, const std::vector<boolean::Cutter>& cutters,
                        const Progress& progress) {
  stages::StageInputs inputs;
  inputs.by_port["surface"] = stages::load_data(parsed.path("input"), stages::DataKind::mesh);
  inputs.by_port["cutters.1"] = std::make_shared<const std::vector<boolean::Cutter>>(cutters);
  const stages::StageOutcome made =
      stages::stage_named("boolean").run(AnyParams::make(parsed.params<boolean::CutSurfaceParams>()), inputs, progress);
  stages::save_data(parsed.path("output"), made.data);
  return made.report();
}

// What one cutter did, under its name.
template <class R>
void add_of_cutter(Report& report, const boolean::Cutter& c, Vec3 spacing_mm, const Outcome<std::monostate, R>& one) {
  if (const auto thin = boolean::thin_cutter(c, spacing_mm)) report.warn(to_text(*thin));
  for (const auto& [name, value] : figures_of(one.result)) report.figures.emplace_back(c.name + "." + name, value);
  for (const Warning& w : boolean::warnings_of(c, one.warnings)) report.warn(to_text(w));
}

Report cut_haptic_file(const cli::ParsedCommand& parsed, const std::vector<boolean::Cutter>& cutters,
                       const Progress& progress) {
  voxel::HapticVolume volume = *std::get<std::shared_ptr<const voxel::HapticVolume>>(
      stages::load_data(parsed.path("input"), stages::DataKind::haptic));
  std::vector<int> numbers;
  for (const std::string& name : parsed.all("shape")) {
    const voxel::HapticShape* shape = volume.find_shape(name);
    if (!shape) throw Error(ExitCode::usage, parsed.text("input"), "--shape", name + ", the volume has no such shape");
    numbers.push_back(shape->number);
  }
  const double widen_mm = parsed.params<boolean::CutSurfaceParams>().widen_mm;
  Report report;
  for (const boolean::Cutter& given : cutters) {
    const boolean::Cutter c = boolean::widened(given, widen_mm);
    add_of_cutter(report, c, volume.voxels.spacing_mm,
                  voxel::cut_volume(volume, boolean::distance_to(c), boolean::bounds_of(c), numbers, progress));
  }
  voxel::write_haptic(parsed.path("output"), volume);
  return report;
}

Report cut_field_file(const cli::ParsedCommand& parsed, grid::Field field, const std::vector<boolean::Cutter>& cutters,
                      const Progress& progress) {
  const double widen_mm = parsed.params<boolean::CutSurfaceParams>().widen_mm;
  Report report;
  for (const boolean::Cutter& given : cutters) {
    const boolean::Cutter c = boolean::widened(given, widen_mm);
    add_of_cutter(report, c, field.spacing_mm,
                  voxel::cut_field(field, boolean::distance_to(c), boolean::bounds_of(c), progress));
  }
  stages::save_data(parsed.path("output"), std::make_shared<const grid::Field>(std::move(field)));
  return report;
}

}  // namespace

const cli::OwnCommand boolean_command([] {
  const stages::StageType& stage = stages::stage_named("boolean");
  cli::Command c;
  c.name = stage.name;
  c.summary = "cuts burr holes and other solids out of a surface, a field or a haptic volume";
  c.description = stage.description +
                  "\n\nA field or a haptic volume is cut voxel by voxel, and the cut surface lies between the voxels "
                  "as the rest does. A cut never makes a shape of a haptic volume grow.";
  c.examples = stage.examples;
  cli::Argument input, cutters, mesh, shape, output;
  input.name = "input";
  input.help = "Surface (.vtp), field or haptic volume (.nrrd).";
  input.positional = input.required = true;
  cutters.name = "cutters";
  cutters.repeated = true;
  cutters.help = "Cutters as `burrhole` makes them (.json).";
  mesh.name = "cutter_mesh";
  mesh.repeated = true;
  mesh.help = "A closed surface to cut away (.vtp, .stl, .ply, .obj, .vtk, .glb).";
  shape.name = "shape";
  shape.kind = cli::Argument::Kind::text;
  shape.repeated = true;
  shape.help = "A shape of a haptic volume to cut; all shapes where none is given.";
  output.name = "output";
  output.kind = cli::Argument::Kind::out_file;
  output.help = "File for the result, with the input's extension.";
  output.required = true;
  c.arguments = {input, cutters, mesh, shape, output, report_argument()};
  c.groups = {cli::ParameterGroup::of<CutterParams>("Cutter"), {"Parameters", stage.make_params}};
  c.run = [](const cli::ParsedCommand& parsed) {
    const std::string extension = parsed.path("input").extension();
    if (extension != ".vtp" && extension != ".nrrd")
      throw Error(ExitCode::usage, parsed.text("input"), "input", "must end in .vtp or .nrrd");
    if (parsed.path("output").extension() != extension)
      throw Error(ExitCode::usage, parsed.text("output"), "output", "must end in " + extension + " like the input");
    if (extension == ".vtp" && parsed.has("shape"))
      throw Error(ExitCode::usage, "", "--shape", "is of a haptic volume, and the input is a surface");
    const std::vector<boolean::Cutter> all = cutters_given(parsed);
    run_with_report(parsed, [&](const Progress& progress) {
      if (extension == ".vtp") return cut_surface_file(parsed, all, progress);
      grid::BoundedGrid nrrd = with_file(
          parsed.text("input"), [&] { return grid::read_nrrd_bounded(parsed.path("input"), grid::labels_limit); });
      if (nrrd.keys.count(voxel::haptic_file_key)) {
        nrrd = {};
        return cut_haptic_file(parsed, all, progress);
      }
      if (holds_hu(nrrd.keys))
        throw Error(ExitCode::bad_input, parsed.text("input"), "content", "HU, must be a field or a haptic volume");
      return cut_field_file(parsed, grid::to_field(std::move(nrrd.grid)), all, progress);
    });
    return ExitCode::ok;
  };
  return c;
});

}  // namespace trephine::tools
