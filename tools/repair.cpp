// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/repair.h"
#include "base/error.h"
#include "cli/argument.h"
#include "commands.h"
#include "meshio/read_mesh.h"
#include "stage_command.h"
#include "stages/data_files.h"

namespace trephine::tools {

cli::Command repair_command() {
  const stages::StageType& stage = stages::stage_named("repair");
  cli::Command c;
  c.name = stage.name;
  c.summary = stage.summary;
  c.description = stage.description;
  c.examples = stage.examples;
  using Kind = cli::Argument::Kind;
  const cli::Argument input =
      cli::positional_argument("surface", Kind::in_file, "Triangles of any kind (.vtp, .stl, .ply, .obj, .vtk, .glb).");
  const cli::Argument output = cli::required_argument("output", Kind::out_file, "File for the surface (.vtp).");
  c.arguments = {input, output, report_argument()};
  c.groups = {{"Parameters", stage.make_params}};
  c.run = [stage](const cli::ParsedCommand& parsed) {
    const std::filesystem::path to = parsed.path("output");
    if (to.extension() != ".vtp") throw Error(ExitCode::usage, to.string(), "output", "must end in .vtp");
    run_with_report(parsed, [&](const Progress& progress) {
      Report read, report;
      stages::StageInputs inputs;
      inputs.by_port["surface"] = std::make_shared<const surface::TriMesh>(
          meshio::read_mesh_file(parsed.path("surface"), read, {}, progress.part(0, 0.2)));
      if (const auto* merged = read.find("points_merged")) report.figures.emplace_back("read_merged_count", *merged);
      if (const auto* dropped = read.find("triangles_dropped"))
        report.figures.emplace_back("read_dropped_count", *dropped);
      stages::save_data(to, with_file(parsed.path("surface").string(), [&] {
                          return stage.run(parsed.groups[0], inputs, report, progress.part(0.2, 1));
                        }));
      return report;
    });
    return ExitCode::ok;
  };
  return c;
}

}  // namespace trephine::tools
