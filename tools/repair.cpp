// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/repair.h"
#include "base/error.h"
#include "cli/argument.h"
#include "cli/command.h"
#include "meshio/read_mesh.h"
#include "stage_command.h"
#include "stages/data_files.h"

namespace trephine::tools {

const cli::OwnCommand repair_command([] {
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
      stages::StageInputs inputs;
      auto read = meshio::read_mesh_file(parsed.path("surface"), {}, progress.part(0, 0.2));
      inputs.by_port["surface"] = std::make_shared<const surface::TriMesh>(std::move(read.value));
      const stages::StageOutcome made = with_file(
          parsed.path("surface").string(), [&] { return stage.run(parsed.groups[0], inputs, progress.part(0.2, 1)); });
      stages::save_data(to, made.data);
      Report report;
      report.add("read_merged_count", read.result.points_merged);
      report.add("read_dropped_count", read.result.triangles_dropped);
      add(report, made.report());
      return report;
    });
    return ExitCode::ok;
  };
  return c;
});

}  // namespace trephine::tools
