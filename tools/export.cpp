// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cstdio>
#include <iostream>

#include "ambf/adf.h"
#include "base/error.h"
#include "base/joined.h"
#include "base/log.h"
#include "base/text.h"
#include "base/write_file.h"
#include "cases/case.h"
#include "cases/glb.h"
#include "cases/slicer_points.h"
#include "cli/argument.h"
#include "cli/command.h"
#include "cli/progress_display.h"
#include "export_dicom.h"
#include "export_parts.h"
#include "export_print.h"
#include "export_scene.h"
#include "export_solids.h"
#include "meshio/export_format.h"
#include "meshio/markups.h"
#include "meshio/read_mesh.h"
#include "stage_command.h"
#include "stages/data_files.h"

namespace trephine::tools {
namespace {

namespace fs = std::filesystem;

bool holds_several(const meshio::ExportFormat& f) { return f.several; }

constexpr const char* markups_format = "mrk.json";

// Every name that --format takes.
std::vector<std::string> format_choices() {
  std::vector<std::string> names;
  for (const meshio::ExportFormat& f : meshio::format_types()) names.emplace_back(f.name);
  for (const meshio::LabelFormat& f : meshio::all_label_formats()) names.emplace_back(f.name);
  for (const char* name : {markups_format, print_format}) names.emplace_back(name);
  for (const std::string& name : scene_format_names()) names.push_back(name);
  for (const std::string& name : dicom_format_names()) names.push_back(name);
  for (const std::string& name : solid_format_names()) names.push_back(name);
  return names;
}

struct ExportParams {
  std::string name;
  bool together = false;
  std::array<double, 3> colour_rgb{0.8, 0.8, 0.8};
  double opacity = 1;
  template <class V>
  static void describe(V& v) {
    using P = ExportParams;
    v.text(&P::name, "name",
           "Name for a surface from a file, for the one file of --together, or for the labels; where empty, the "
           "input's name, or labels.");
    static const std::string together =
        "All anatomies in one file (" + meshio::format_names(holds_several) + " hold several).";
    v.flag(&P::together, "together", together.c_str());
    v.numbers(&P::colour_rgb, "colour_rgb", Range{0, 1},
              "Colour (sRGB) of a surface from a file; a case has its own colours.");
    v.number(&P::opacity, "opacity", Range{0, 1}, "Opacity of a surface from a file, where the format has one.");
  }
};

struct Formats {
  std::vector<const meshio::ExportFormat*> surfaces;
  std::vector<const meshio::LabelFormat*> labels;
  bool markups = false;
  SceneFormats scenes;
  DicomFormats dicom;
  SolidFormats solids;
  bool print = false;
};

template <class Format>
void add_once(std::vector<const Format*>& formats, const Format& format) {
  if (std::find(formats.begin(), formats.end(), &format) == formats.end()) formats.push_back(&format);
}

Formats formats_of(const cli::ParsedCommand& parsed) {
  const std::vector<meshio::LabelFormat>& all_labels = meshio::all_label_formats();
  Formats formats;
  for (const std::string& name : items_of(parsed, "format")) {
    const auto labels = std::find_if(all_labels.begin(), all_labels.end(),
                                     [&](const meshio::LabelFormat& f) { return name == f.name; });
    const meshio::ExportFormat* surface = meshio::find_export_format(name);
    if (formats.dicom.take(name) || formats.scenes.take(name) || formats.solids.take(name)) continue;
    if (name == markups_format)
      formats.markups = true;
    else if (name == print_format)
      formats.print = true;
    else if (labels != all_labels.end())
      add_once(formats.labels, *labels);
    else if (surface)
      add_once(formats.surfaces, *surface);
    else
      unknown_name("--format", name, format_choices());
  }
  return formats;
}

void load_case_surfaces(const fs::path& folder, const std::vector<std::string>& wanted, ExportInput& input,
                        Report& report, const Progress& progress) {
  std::vector<std::string> known;
  for (const cases::CaseAnatomy& a : input.manifest.anatomies) known.push_back(a.name);
  for (const std::string& name : wanted)
    if (!input.manifest.find_anatomy(name)) unknown_name("--anatomy", name, known);
  for (const cases::CaseAnatomy& a : input.manifest.anatomies) {
    progress.check();
    const bool named = std::find(wanted.begin(), wanted.end(), a.name) != wanted.end();
    if (!wanted.empty() && !named) continue;
    if (a.file.empty()) {
      const std::string what = "the case holds no surface of it; it is displayed from the haptic volume";
      if (named) throw Error(ExitCode::bad_input, folder.string(), a.name, what);
      report.warn(a.name + ": " + what);
      continue;
    }
    const std::string bytes = cases::read_case_file(folder, *input.manifest.find_file(a.file));
    input.meshes.push_back(with_file(a.file, [&] { return cases::read_glb(bytes).mesh; }));
    input.surfaces.push_back({&input.meshes.back(), a.name, a.colour_rgb, a.opacity, false});
  }
}

void load_file_surface(const fs::path& file, const ExportParams& params, ExportInput& input, const Progress& progress) {
  const std::string name = params.name.empty() ? file.stem().string() : params.name;
  check_export_name("--name", name);
  input.meshes.push_back(meshio::read_mesh_file(file, {}, progress).value);
  input.surfaces.push_back({&input.meshes.back(), name, params.colour_rgb, params.opacity, false});
}

ExportInput load_input(const cli::ParsedCommand& parsed, bool surfaces, Report& report, const Progress& progress) {
  ExportInput input;
  if (!parsed.has("input")) return input;
  const fs::path path = parsed.path("input");
  const auto wanted = items_of(parsed, "anatomy");
  if (fs::is_directory(path)) input.manifest = cases::read_case(path);
  if (!surfaces) return input;
  if (fs::is_directory(path)) {
    load_case_surfaces(path, wanted, input, report, progress);
  } else {
    if (!wanted.empty()) export_usage("--anatomy", "is for a case; a file holds one surface");
    load_file_surface(path, parsed.params<ExportParams>(), input, progress);
  }
  std::vector<std::string> names;
  for (const meshio::ExportSurface& s : input.surfaces) names.push_back(s.name);
  for (const std::string& name : items_of(parsed, "texture_coordinates")) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) unknown_name("--texture-coordinates", name, names);
    input.surfaces[std::size_t(found - names.begin())].texture_coordinates = true;
  }
  return input;
}

struct Exported {
  std::vector<meshio::ExportFile> files;
  std::vector<std::string> table;  ///< one line for each file
};

// Encodes a surface, lets another program read it, and keeps the bytes: nothing is written before all files are valid.
void export_one(const meshio::ExportFormat& format, const std::vector<meshio::ExportSurface>& surfaces,
                const std::string& stem, Exported& out, Report& report, const Progress& progress) {
  auto made = meshio::encode_surfaces(format, surfaces, stem, progress.part(0, 0.5));
  const meshio::ExportCheck check = meshio::verify_export(format, surfaces, made, progress.part(0.5, 1));
  const meshio::ExportFile& main = made.back();
  report.add(main.name + ".triangles_count", check.triangles);
  report.add(main.name + ".bytes", main.bytes.size());
  report.add(main.name + ".reread_by", check.read_by);
  report.add(main.name + ".reread_difference_mm", check.largest_difference_mm);
  const auto bounds = [&](const char* which, Vec3 v) {
    report.figures.emplace_back(main.name + which, std::vector<double>{v.x, v.y, v.z});
  };
  bounds(".bounds_min_mm", check.bounds_mm.min_mm);
  bounds(".bounds_max_mm", check.bounds_mm.max_mm);
  char line[200];
  std::snprintf(line, sizeof line, "%-24s %11s %8.1f   %-10s %13.2g", main.name.c_str(),
                grouped_text(static_cast<long long>(check.triangles)).c_str(), double(main.bytes.size()) / 1e6,
                check.read_by.c_str(), check.largest_difference_mm);
  out.table.emplace_back(line);
  for (meshio::ExportFile& f : made) out.files.push_back(std::move(f));
}

Exported export_surfaces(const ExportInput& input, const std::vector<const meshio::ExportFormat*>& formats,
                         const ExportParams& params, const std::string& together_name, Report& report,
                         const Progress& progress) {
  Exported out;
  const std::size_t groups = params.together ? 1 : input.surfaces.size(), all = groups * formats.size();
  for (std::size_t g = 0; g < groups; ++g)
    for (std::size_t f = 0; f < formats.size(); ++f) {
      const double done = double(g * formats.size() + f);
      const Progress part = progress.part(done / double(all), (done + 1) / double(all));
      if (params.together)
        export_one(*formats[f], input.surfaces, together_name, out, report, part);
      else
        export_one(*formats[f], {input.surfaces[g]}, input.surfaces[g].name, out, report, part);
    }
  return out;
}

void check_combination(const cli::ParsedCommand& parsed, const Formats& formats) {
  const auto& params = parsed.params<ExportParams>();
  if (!params.name.empty()) check_export_name("--name", params.name);
  if (formats.labels.empty() == parsed.has("labels")) {
    const std::string names = joined(meshio::all_label_formats(), ", ", &meshio::LabelFormat::name);
    export_usage("--labels", "and --format " + names + " belong together");
  }
  check_dicom(parsed, formats.dicom);
  if ((formats.markups || formats.scenes.any() || formats.print) &&
      (!parsed.has("input") || !fs::is_directory(parsed.path("input"))))
    export_usage("INPUT", std::string("must be a case's folder for ") + markups_format + ", " + print_format + " and " +
                              joined(scene_format_names()));
  if ((!formats.surfaces.empty() || formats.solids.any()) && !parsed.has("input"))
    export_usage("INPUT", "is needed for surfaces: a case or a file");
  if (params.together)
    for (const meshio::ExportFormat* f : formats.surfaces)
      if (!f->several) export_usage("--together", std::string(f->name) + " holds one surface a file");
}

// Landmarks, targets and trajectories, each read back as it would be given to a run.
std::vector<meshio::ExportFile> markup_files(const cases::CaseManifest& manifest, const meshio::MarkupsParams& params,
                                             Report& report) {
  std::vector<meshio::ExportFile> files;
  for (const meshio::Markup& m : meshio::markups_of_case(manifest, params)) {
    files.push_back({m.name + "." + markups_format, meshio::encode_slicer_markups(m)});
    const auto back = cases::parse_slicer_markups(files.back().bytes);
    for (std::size_t i = 0; i < m.points.size(); ++i)
      if (back.size() != m.points.size() || back[i].position_mm != m.points[i].position_mm)
        throw Error(ExitCode::io, files.back().name, m.points[i].label, "what is written does not read back");
    report.add(files.back().name + ".points_count", m.points.size());
  }
  if (files.empty()) throw Error(ExitCode::bad_input, "", "", "the case has no landmark, target or burr hole");
  return files;
}

// Fills the report (for --report) and returns the text to be printed.
std::string run_export(const cli::ParsedCommand& parsed, Report& report, const Progress& progress) {
  const auto& params = parsed.params<ExportParams>();
  const Formats formats = formats_of(parsed);
  check_combination(parsed, formats);
  const bool from_file = formats.solids.any() && !fs::is_directory(parsed.path("input"));
  const ExportInput input = load_input(parsed, !formats.surfaces.empty() || from_file, report, progress.part(0, 0.1));
  if (!formats.surfaces.empty() && input.surfaces.empty())
    throw Error(ExitCode::bad_input, parsed.text("input"), "", "holds no surface");
  std::string stem = params.name;
  if (stem.empty() && params.together)
    stem = input.manifest.case_token.empty() ? input.surfaces.at(0).name : input.manifest.case_token;

  const fs::path out = parsed.path("out");
  const Exported exported = export_surfaces(input, formats.surfaces, params, stem, report, progress.part(0.1, 0.8));
  std::string text;
  if (!exported.table.empty()) text = "file                       triangles       MB   re-read by   off by, mm\n";
  for (const std::string& line : exported.table) text += line + "\n";
  std::vector<meshio::ExportFile> markups;
  if (formats.markups) {
    markups = with_file(parsed.text("input"),
                        [&] { return markup_files(input.manifest, parsed.params<meshio::MarkupsParams>(), report); });
    for (const meshio::ExportFile& f : markups) text += f.name + "\n";
  }
  Report labels;
  meshio::LabelMap map;
  if (!formats.labels.empty()) {
    auto made = label_map_of(parsed, input.manifest, progress.part(0.8, 0.95));
    labels = printed(made);
    map = std::move(made.value);
  }
  const SceneExport scenes = export_scenes(parsed, formats.scenes, params.name, report, progress.part(0.8, 0.95));
  if (!scenes.table.empty()) text += "scene                               MB   holds\n" + scenes.table;
  DicomExport dicom;
  if (formats.dicom.any()) {
    dicom = export_dicom(parsed, formats.dicom, params.name, report, progress.part(0.8, 0.95));
    text += "object                              MB   holds\n" + dicom.table;
  }
  SolidExport solids;
  if (formats.solids.any()) {
    const std::string own = !params.name.empty() ? params.name
                            : from_file          ? input.surfaces.at(0).name
                                                 : input.manifest.case_token;
    solids = export_solids(parsed, formats.solids, input, own, report, progress.part(0.95, 1));
    text += solids.table;
  }
  PrintExport prints;
  if (formats.print) {
    prints = export_print(parsed, params.name, report, progress.part(0.1, 1));
    text += prints.table;
  }
  make_output_folder(out);
  write_dicom(out, dicom);
  write_scenes(out, scenes);
  write_solids(out, solids);
  meshio::write_export(out, prints.files);
  meshio::write_export(out, exported.files);
  meshio::write_export(out, markups);
  for (const meshio::LabelFormat* f : formats.labels)
    f->write(out / ((params.name.empty() ? "labels" : params.name) + "." + f->name), map);
  text += stages::report_text(labels);
  for (const auto& f : labels.figures) report.figures.push_back(f);
  return text;
}

// What the formats hold, from their own declarations.
std::string formats_text() {
  std::vector<std::string> formats;
  for (const meshio::ExportFormat& f : meshio::format_types()) formats.emplace_back(f.help);
  const auto says_space = [](const meshio::ExportFormat& f) { return f.says_space; };
  const auto in_metres = [](const meshio::ExportFormat& f) { return f.metres_y_up; };
  const auto rounds = [](const meshio::ExportFormat& f) { return f.precision == meshio::Precision::float32_world; };
  const auto colourless = [](const meshio::ExportFormat& f) { return !f.read_back.colour; };
  std::string text = joined(formats) + ". Coordinates are DICOM patient LPS in mm, which " +
                     meshio::format_names(says_space) + " say as 3D Slicer reads it (SPACE=LPS); " +
                     meshio::format_names(in_metres) + " is in metres, Y up. " + meshio::format_names(rounds) +
                     " hold float32, " + meshio::format_names(colourless) +
                     " no colour.\n\n"
                     "Every surface is checked in its rounded coordinates (closed, 2-manifold, no "
                     "self-intersections), and every file is read back by another program's reader and compared, "
                     "triangle by triangle, before anything is written.";
  for (const meshio::LabelFormat& f : meshio::all_label_formats())
    text += "\n\nFormat " + std::string(f.name) + " is " + f.help;
  return text +
         "\n\nFormat mrk.json is markups for 3D Slicer, of a case: its landmarks (landmarks.mrk.json, which `run "
         "--landmarks` reads back), its targets (targets.mrk.json), and the axis of each burr hole as a line "
         "(trajectory-NAME.mrk.json).\n\n" +
         scene_formats_help + "\n\n" + dicom_formats_help + "\n\n" + solid_formats_help + "\n\n" + print_format_help;
}

}  // namespace

const cli::OwnCommand export_command([] {
  cli::Command c;
  c.name = "export";
  c.summary = "writes surfaces and labels in the formats of other programs";
  c.description =
      "From a case (a folder with case.json) or a surface file (.vtp .stl .ply .obj .vtk .glb), one file an anatomy "
      "and format: " +
      formats_text();
  c.examples = {"trephine export library/head-01 --format stl,ply --out exported",
                "trephine export library/head-01 --format obj --anatomy skin --texture-coordinates skin --out exported",
                "trephine export library/head-01 --format x3d --together --out exported",
                "trephine export skull.vtp --format stl --out exported",
                "trephine export library/head-01 --format mrk.json --out exported",
                "trephine export library/head-01 --format slicer-mrb --out exported",
                "trephine export library/head-01 --format ambf --out volumetric_drilling/ADF",
                "trephine export library/head-01 --format dicom-seg,dicom-rtss --series scan --out exported",
                "trephine export library/head-01 --format tetra-vtu,tetra-msh --size-mm 5 --out exported",
                "trephine export library/head-01 --format sdf --densities skull=1900 --out exported",
                "trephine export library/head-01 --format print --out printed",
                "trephine export --format seg.nrrd --labels skin=skin.nrrd,skull=skull.nrrd --out exported"};
  const auto argument = [](const char* name, cli::Argument::Kind kind, const std::string& help) {
    cli::Argument a;
    a.name = name;
    a.kind = kind;
    a.help = help;
    return a;
  };
  cli::Argument input = argument("input", cli::Argument::Kind::in_path, "A case's folder, or a surface file.");
  input.positional = true;
  cli::Argument format = argument("format", cli::Argument::Kind::text,
                                  "Formats, with commas between them: " + joined(format_choices()) + ".");
  format.required = format.repeated = true;
  const cli::Argument out = cli::required_argument("out", cli::Argument::Kind::out_folder,
                                                   "Folder for the files; files of the same name are replaced.");
  cli::Argument anatomy =
      argument("anatomy", cli::Argument::Kind::text, "Anatomies of the case to export; all where none is given.");
  cli::Argument texture =
      argument("texture_coordinates", cli::Argument::Kind::text,
               "Surfaces that get spherical texture coordinates, where the format has them (not " +
                   meshio::format_names([](const meshio::ExportFormat& f) { return !f.texture; }) + ").");
  cli::Argument labels =
      argument("labels", cli::Argument::Kind::text, "Shapes of a segmentation: NAME=FIELD.nrrd, with commas.");
  anatomy.repeated = texture.repeated = labels.repeated = true;
  const cli::Argument series =
      argument("series", cli::Argument::Kind::in_scan,
               "For dicom-seg, dicom-rtss and dicom-ct: the folder or archive of the scan that "
               "the case was made of; another one is refused (65).");
  c.arguments = {input, format, out, anatomy, texture, labels, series, report_argument()};
  c.groups = {cli::ParameterGroup::of<ExportParams>("Parameters"),
              cli::ParameterGroup::of<meshio::MarkupsParams>("Markups"),
              cli::ParameterGroup::of<ambf::AdfParams>("AMBF"), cli::ParameterGroup::of<DicomParams>("DICOM")};
  for (const cli::ParameterGroup& group : solid_groups()) c.groups.push_back(group);
  c.groups.push_back(print_group());
  c.run = [](const cli::ParsedCommand& parsed) {
    Report report;
    std::string text;
    {
      cli::ProgressDisplay display(parsed.quiet);
      text = run_export(parsed, report, display.start("export"));
      display.finish("export", "");
    }
    if (parsed.has("report")) write_file(parsed.path("report"), stages::report_json(report));
    for (const std::string& w : report.warnings) log_warning(w);
    if (!parsed.quiet) std::cout << text;
    return ExitCode::ok;
  };
  return c;
});

}  // namespace trephine::tools
