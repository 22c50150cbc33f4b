// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "cli/command.h"
#include "commands.h"
#include "schemas.h"
#include "stage_command.h"

namespace trephine::tools {
namespace {

cli::Program declare() {
  cli::Program program;
  program.name = "trephine";
  program.version = TREPHINE_VERSION;
  program.summary = "turns CT series into patient models for surgical simulation";
  program.commands = {run_command(),
                      trade_command(),
                      library_build_command(),
                      library_list_command(),
                      library_show_command(),
                      library_verify_command(),
                      library_gc_command(),
                      library_job_command(),
                      library_plan_command(),
                      library_one_command(),
                      library_status_command(),
                      library_cancel_command(),
                      library_timeline_command(),
                      library_task_command(),
                      library_finish_command(),
                      page_command(),
                      diff_command(),
                      correction_command(),
                      preview_command(),
                      export_command(),
                      convert_command(),
                      phantom_command(),
                      rubric_command(),
                      library_approve_command(),
                      desk_command(),
                      questionnaire_command()};
  // Stages as their declarations say, except those whose commands do more than run the stage.
  std::vector<cli::Command> own = {import_command(),   anatomy_command(), boolean_command(), measure_command(),
                                   voxelize_command(), repair_command(),  register_command()};
  for (const stages::StageType& stage : stages::stage_types()) {
    const auto more = std::find_if(own.begin(), own.end(), [&](const cli::Command& c) { return c.name == stage.name; });
    program.commands.push_back(more == own.end() ? make_stage_command(stage) : *more);
  }
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
