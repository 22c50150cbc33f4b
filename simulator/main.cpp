// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/command.h"
#include "commands/commands.h"

namespace trephine {
namespace {

cli::Program declare() {
  cli::Program program;
  program.name = "trephine-sim";
  program.version = TREPHINE_VERSION;
  program.summary = "runs surgical simulations on the cases that trephine makes";
  program.reference_folder = "docs/reference-sim";
  program.commands = {commands::check_command(),
                      commands::servo_command(),
                      commands::replay_command(),
                      commands::lesson_command(),
                      commands::score_command(),
                      commands::fluoro_command(),
                      commands::exercise_command(),
                      commands::calibrate_command(),
                      commands::register_command(),
                      commands::sign_command(),
                      commands::study_command(),
                      commands::group_command(),
                      commands::export_recording_command(),
                      commands::explain_command(),
                      commands::compare_command(),
                      commands::lessons_command()};
#ifdef TREPHINE_WITH_DISPLAY
  program.commands.push_back(commands::play_command());
  program.commands.push_back(commands::render_command());
#endif
  return program;
}

}  // namespace
}  // namespace trephine

int main(int argc, char** argv) { return trephine::cli::run_program("trephine-sim", trephine::declare, argc, argv); }
