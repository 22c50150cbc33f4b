// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "cli/command.h"
#include "schemas.h"
#include "stage_command.h"

namespace trephine::tools {
namespace {

cli::Program declare() {
  cli::Program program;
  program.name = "trephine";
  program.version = TREPHINE_VERSION;
  program.summary = "turns CT series into patient models for surgical simulation";
  program.commands = cli::OwnCommand::all();
  // Stages as their declarations say, except those whose commands do more than run the stage.
  for (const stages::StageType& stage : stages::stage_types())
    if (std::none_of(program.commands.begin(), program.commands.end(),
                     [&](const auto& c) { return c.name == stage.name; }))
      program.commands.push_back(make_stage_command(stage));
  program.files = {{"PREFIX/share/trephine/configs/*.yaml",
                    "Configurations of cases, for any head (ct_head.yaml) and for the sample (sample.yaml), and their "
                    "scenes; PREFIX is /usr for the Debian package."},
                   {"PREFIX/share/trephine/pipelines/*.yaml", "The recipes, which say how each anatomy is made."},
                   {"PREFIX/share/trephine/sample_dicom/", "The CT series of a synthetic head."},
                   {"PREFIX/share/doc/trephine/", "README.md, the reference of all parameters, the format of a case."},
                   {"LIBRARY/.trephine-cache/",
                    "Outputs of stages that a later run reuses; it holds patient data as LIBRARY does."}};
  program.more_reference_pages = file_schemas;
  return program;
}

}  // namespace
}  // namespace trephine::tools

int main(int argc, char** argv) { return trephine::cli::run_program("trephine", trephine::tools::declare, argc, argv); }
