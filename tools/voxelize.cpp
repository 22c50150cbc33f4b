// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/error.h"
#include "base/write_file.h"
#include "commands.h"
#include "grid/nrrd.h"
#include "meshing/contour.h"
#include "named_values.h"
#include "pipeline/yaml_document.h"
#include "stage_command.h"
#include "stages/data_files.h"
#include "stages/haptic.h"
#include "voxel/haptic_file.h"

namespace trephine {
namespace {

HapticShapeSpec& shape_named(HapticSpec& spec, const std::string& name, const char* flag) {
  for (HapticShapeSpec& s : spec.shapes)
    if (s.name == name) return s;
  throw Error(ExitCode::usage, "", flag, name + ", no such --shape or --window is given");
}

HapticShapeSpec& add_shape(HapticSpec& spec, const std::string& name, const char* flag) {
  if (!is_plain_name(name))
    throw Error(ExitCode::usage, "", flag, name + ", a name has letters a-z, digits and _ only");
  for (const HapticShapeSpec& s : spec.shapes)
    if (s.name == name) throw Error(ExitCode::usage, "", flag, name + ", is given twice");
  spec.shapes.emplace_back();
  spec.shapes.back().name = name;
  return spec.shapes.back();
}

HapticSpec spec_of(const ParsedCommand& parsed) {
  HapticSpec spec;
  if (parsed.has("shape") == parsed.has("window"))
    throw Error(ExitCode::usage, "", "--shape, --window", "give shapes as surfaces, or as windows of HU");
  for (const std::string& text : parsed.all("shape")) add_shape(spec, named_value("--shape", text).first, "--shape");
  for (const std::string& text : parsed.all("window")) {
    const auto [name, value] = named_value("--window", text);
    const std::vector<double> hu = numbers_of("--window", value, 2);
    for (const double v : hu)
      if (!(v >= -32768 && v <= 32767) || v != static_cast<std::int16_t>(v))
        throw Error(ExitCode::usage, "", "--window", value + ", must be two whole HU from -32768 to 32767");
    if (hu[0] > hu[1]) throw Error(ExitCode::usage, "", "--window", value + ", must begin with the lower HU");
    HapticShapeSpec& s = add_shape(spec, name, "--window");
    s.low_hu = static_cast<std::int16_t>(hu[0]);
    s.high_hu = static_cast<std::int16_t>(hu[1]);
    spec.encoding = HapticEncoding::hu;
  }
  if (parsed.has("window") && (parsed.has("clear") || parsed.has("region_of")))
    throw Error(ExitCode::usage, "", "--clear, --region-of", "need surfaces, and --window has none");
  if (parsed.has("cutters") != parsed.has("drill"))
    throw Error(ExitCode::usage, "", "--cutters, --drill", "go together: what cuts, and which shapes");
  for (const std::string& text : parsed.all("clear")) {
    const auto [name, value] = named_value("--clear", text);
    const auto [of, mm] = named_value("--clear", value);
    HapticShapeSpec& s = shape_named(spec, name, "--clear");
    shape_named(spec, of, "--clear");
    s.clear_of = of;
    if (name == of) throw Error(ExitCode::usage, "", "--clear", text + ", names the shape itself");
    s.clear_mm = number_of("--clear", mm, 0.1, 100);
  }
  for (const std::string& text : parsed.all("drill")) {
    const bool wider = text.find('=') != std::string::npos;
    const auto [name, widen] = wider ? named_value("--drill", text) : std::make_pair(text, std::string("0"));
    HapticShapeSpec& s = shape_named(spec, name, "--drill");
    s.drilled = true;
    s.widen_mm = number_of("--drill", widen, 0, 50);
  }
  spec.region_of = parsed.text("region_of");
  if (!spec.region_of.empty()) shape_named(spec, spec.region_of, "--region-of");
  return spec;
}

// A shape's surface: read, or contoured from its field.
std::shared_ptr<const TriMesh> surface_of(const std::filesystem::path& file, const Progress& progress) {
  if (file.extension() != ".nrrd") return std::get<std::shared_ptr<const TriMesh>>(load_data(file, DataKind::mesh));
  Nrrd nrrd = read_nrrd(file);
  if (holds_hu(nrrd.keys))
    throw Error(ExitCode::bad_input, file.string(), "content", "HU, must be a field: segment it first");
  Report ignored;
  const Field field = to_field(std::move(nrrd.grid));
  return std::make_shared<const TriMesh>(
      with_file(file.string(), [&] { return contour(field, ContourParams{}, ignored, progress); }));
}

Argument text_argument(const char* name, const char* help) {
  Argument a;
  a.name = name;
  a.kind = Argument::Kind::text;
  a.repeated = true;
  a.help = help;
  return a;
}

}  // namespace

Command voxelize_command() {
  const StageType stage = voxelize_stage({});
  Command c;
  c.name = stage.name;
  c.summary = stage.summary;
  c.description = stage.description;
  c.examples = {
      "trephine voxelize volume.nrrd --shape brain=brain.nrrd --shape skull=skull.nrrd --shape skin=skin.nrrd "
      "--clear skin=brain=5 --output haptic.nrrd",
      "trephine voxelize volume.nrrd --window bone=300,3000 --spacing-mm 0.5,0.5,1 --output haptic.nrrd"};
  Argument volume, region, cutters, output, hardness;
  volume.name = "volume";
  volume.help = "The scan (.nrrd): its axes are the haptic volume's.";
  volume.positional = volume.required = true;
  region.name = "region_of";
  region.kind = Argument::Kind::text;
  region.help = "Shape whose box, with the margin, is the region; all shapes' where it is not given.";
  cutters.name = "cutters";
  cutters.repeated = true;
  cutters.help = "Cutters (.json) to cut from the shapes that --drill names.";
  output.name = "output";
  output.kind = Argument::Kind::out_file;
  output.help = "Where the haptic volume goes (.nrrd).";
  output.required = true;
  hardness.name = "hardness";
  hardness.kind = Argument::Kind::out_file;
  hardness.help = "Where the hardness volume goes (.nrrd); needs --hardness-high-hu.";
  c.arguments = {
      volume,
      text_argument("shape", "NAME=FILE: a shape's surface (.vtp) or field (.nrrd); the first has precedence."),
      text_argument("window", "NAME=LOW,HIGH: a shape as a window of the scan's own HU."),
      text_argument("clear", "NAME=OTHER=MM: nothing of the shape so near another one."),
      text_argument("drill", "NAME or NAME=MM: a shape that --cutters cut, so much wider all around."),
      region,
      cutters,
      output,
      hardness,
      report_argument()};
  c.groups = {{"Parameters", stage.make_params}};
  c.run = [](const ParsedCommand& parsed) {
    const HapticSpec spec = spec_of(parsed);
    const auto& params = parsed.params<VoxelizeParams>();
    const bool hard = params.hardness_high_hu > params.hardness_low_hu;
    if (hard != parsed.has("hardness"))
      throw Error(ExitCode::usage, "", "--hardness, --hardness-high-hu", "go together");
    if (hard && std::filesystem::weakly_canonical(parsed.path("hardness")) ==
                    std::filesystem::weakly_canonical(parsed.path("output")))
      throw Error(ExitCode::usage, parsed.text("output"), "--hardness, --output", "are the same file");
    for (const char* file : {"output", "hardness"})
      if (parsed.has(file) && parsed.path(file).extension() != ".nrrd")
        throw Error(ExitCode::usage, parsed.text(file), file, "must end in .nrrd");
    run_with_report(parsed, [&](const Progress& progress) {
      StageInputs inputs;
      inputs.by_port["volume"] = load_data(parsed.path("volume"), DataKind::volume);
      for (const std::string& text : parsed.all("shape")) {
        const auto [name, file] = named_value("--shape", text);
        inputs.by_port["shape." + name] = surface_of(file, progress.part(0, 0.2));
      }
      const std::vector<std::string> files = parsed.all("cutters");
      for (std::size_t i = 0; i < files.size(); ++i)
        inputs.by_port["cutters." + std::to_string(1000 + i)] = load_data(files[i], DataKind::cutters);
      Report report;
      const StageData data = voxelize_stage(spec).run(parsed.groups[0], inputs, report, progress.part(0.2, 1));
      const HapticVolume& made = *std::get<std::shared_ptr<const HapticVolume>>(data);
      if (hard) write_file(parsed.path("hardness"), encode_hardness(made));
      write_haptic(parsed.path("output"), made);
      return report;
    });
    return ExitCode::ok;
  };
  return c;
}

}  // namespace trephine
