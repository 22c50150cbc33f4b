// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/voxelize.h"

#include <algorithm>

#include "base/error.h"
#include "base/write_file.h"
#include "cli/command.h"
#include "config/declared.h"
#include "stage_command.h"
#include "voxel/haptic_file.h"

namespace trephine::tools {
namespace {

// Parameters in which every given surface is a shape, with what the command line says of shapes. The order is that of
// the command line: the first shape has precedence.
AnyParams shapes_of(const cli::ParsedCommand& parsed) {
  stages::VoxelizeStageParams params = parsed.params<stages::VoxelizeStageParams>();
  const bool hu = params.encoding == voxel::HapticEncoding::hu;
  if (hu == parsed.has("shape") || (hu && params.shapes.empty()))
    throw Error(ExitCode::usage, "", "--shape, --encoding", "give shapes as surfaces, or as windows of HU");
  Named<stages::HapticShapeParams> surfaces;
  for (const std::string& text : parsed.all("shape")) {
    const std::string name = text.substr(0, text.find('='));
    const stages::HapticShapeParams* said = find_item(params.shapes, name);
    surfaces.emplace_back(name, said ? *said : stages::HapticShapeParams());
  }
  const auto require_surface = [&](const char* flag, const std::string& name, const char* also) {
    const std::vector<std::string> others = parsed.all(also);
    const bool given = find_item(surfaces, name) || std::any_of(others.begin(), others.end(), [&](const auto& text) {
                         return text.rfind(name + "=", 0) == 0;
                       });
    if (!name.empty() && !given) throw Error(ExitCode::usage, "", flag, name + ", no such --shape is given");
  };
  for (const auto& [name, shape] : params.shapes) {
    if (!hu) require_surface("--shapes", name, "shape");
    require_surface("--shapes", shape.clear_of, "clear");
  }
  if (!parsed.has("region")) require_surface("--region-of", params.region_of, "shape");
  if (!hu) params.shapes = surfaces;
  for (const auto& [name, shape] : params.shapes)
    if (!config::is_plain_name(name))
      throw Error(ExitCode::usage, "", "--shape", name + ", a name has letters a-z, digits and _ only");
  for (const auto& [name, drill] : params.drill)
    if (!find_item(params.shapes, name)) throw Error(ExitCode::usage, "", "--drill", name + ", is none of the shapes");
  return AnyParams::make(params);
}

void check_flags(const cli::ParsedCommand& parsed) {
  const auto& params = parsed.params<stages::VoxelizeStageParams>();
  if (parsed.has("cutters") != !params.drill.empty())
    throw Error(ExitCode::usage, "", "--cutters, --drill", "go together: what cuts, and which shapes");
  const bool hard = params.hardness_high_hu > params.hardness_low_hu;
  if (hard != parsed.has("hardness")) throw Error(ExitCode::usage, "", "--hardness, --hardness-high-hu", "go together");
  if (hard && std::filesystem::weakly_canonical(parsed.path("hardness")) ==
                  std::filesystem::weakly_canonical(parsed.path("output")))
    throw Error(ExitCode::usage, parsed.text("output"), "--hardness, --output", "are the same file");
  for (const char* file : {"output", "hardness"})
    if (parsed.has(file) && parsed.path(file).extension() != ".nrrd")
      throw Error(ExitCode::usage, parsed.text(file), file, "must end in .nrrd");
}

}  // namespace

// The stage's command, which also writes the hardness volume.
const cli::OwnCommand voxelize_command([] {
  const stages::StageType& stage = stages::stage_named("voxelize");
  cli::Command c = make_stage_command(stage);
  cli::Argument hardness;
  hardness.name = "hardness";
  hardness.kind = cli::Argument::Kind::out_file;
  hardness.help = "File for the hardness volume (.nrrd); needs --hardness-high-hu.";
  c.arguments.push_back(hardness);
  c.run = [&stage](const cli::ParsedCommand& parsed) {
    check_flags(parsed);
    const AnyParams params = shapes_of(parsed);
    run_with_report(parsed, [&](const Progress& progress) {
      const stages::StageInputs inputs = stage_inputs(stage, parsed);
      const stages::StageOutcome made = stage.run(params, inputs, progress);
      const voxel::HapticVolume& volume = *std::get<std::shared_ptr<const voxel::HapticVolume>>(made.data);
      if (parsed.has("hardness")) write_file(parsed.path("hardness"), voxel::encode_hardness(volume));
      voxel::write_haptic(parsed.path("output"), volume);
      return made.report();
    });
    return ExitCode::ok;
  };
  return c;
});

}  // namespace trephine::tools
