// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/command.h"
#include "commands.h"

int main(int argc, char** argv) {
  using namespace trephine;
  Program program;
  program.name = "trephine-sim";
  program.version = TREPHINE_VERSION;
  program.summary = "runs surgical simulations on the cases that trephine makes";
  program.reference_folder = "docs/reference-sim";
  program.commands = {check_command(), servo_command(), replay_command()};
  return run_program(program, argc, argv);
}
