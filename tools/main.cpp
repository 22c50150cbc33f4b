// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/command.h"
#include "commands.h"
#include "recipe_schema.h"

int main(int argc, char** argv) {
  using namespace trephine;
  Program program;
  program.name = "trephine";
  program.version = TREPHINE_VERSION;
  program.summary = "turns CT series into patient models for surgical simulation";
  program.commands = {run_command(),     import_command(),  segment_command(),  contour_command(), decimate_command(),
                      smooth_command(),  normals_command(), burrhole_command(), boolean_command(), voxelize_command(),
                      measure_command(), phantom_command(), export_command()};
  program.more_reference_pages = [] {
    return std::vector<std::pair<std::string, std::string>>{{"recipe.schema.json", recipe_schema()}};
  };
  return run_program(program, argc, argv);
}
