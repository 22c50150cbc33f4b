// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/command.h"

namespace trephine {
namespace {

cli::Program declare() {
  cli::Program program;
  program.name = "trephine-sim";
  program.version = TREPHINE_VERSION;
  program.summary = "runs surgical simulations on the cases that trephine makes";
  program.commands = cli::OwnCommand::all();
  return program;
}

}  // namespace
}  // namespace trephine

int main(int argc, char** argv) { return trephine::cli::run_program("trephine-sim", trephine::declare, argc, argv); }
