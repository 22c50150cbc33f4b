// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/command.h"
#include "commands/commands.h"

namespace trephine {
namespace {

Program declare() {
  Program program;
  program.name = "trephine-sim";
  program.version = TREPHINE_VERSION;
  program.summary = "runs surgical simulations on the cases that trephine makes";
  program.reference_folder = "docs/reference-sim";
  program.commands = {check_command(), servo_command(),  replay_command(),   lesson_command(),
                      score_command(), fluoro_command(), exercise_command(), calibrate_command()};
#ifdef TREPHINE_WITH_DISPLAY
  program.commands.push_back(play_command());
  program.commands.push_back(render_command());
#endif
  return program;
}

}  // namespace
}  // namespace trephine

int main(int argc, char** argv) { return trephine::run_program("trephine-sim", trephine::declare, argc, argv); }
