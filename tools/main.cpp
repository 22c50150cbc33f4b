// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/command.h"
#include "commands.h"
#include "recipe_schema.h"

namespace trephine {
namespace {

Program declare() {
  Program program;
  program.name = "trephine";
  program.version = TREPHINE_VERSION;
  program.summary = "turns CT series into patient models for surgical simulation";
  program.commands = {run_command(),          trade_command(),        import_command(),         segment_command(),
                      labels_command(),       presegment_command(),   snake_command(),          landmarks_command(),
                      canal_command(),        clavicle_command(),     vein_command(),           contour_command(),
                      decimate_command(),     smooth_command(),       normals_command(),        burrhole_command(),
                      boolean_command(),      voxelize_command(),     repair_command(),         simplify_command(),
                      anatomy_command(),      resample_command(),     remesh_command(),         measure_command(),
                      phantom_command(),      export_command(),       deface_command(),         library_build_command(),
                      library_list_command(), library_show_command(), library_verify_command(), library_gc_command(),
                      library_job_command()};
  program.files = {{"PREFIX/share/trephine/configs/*.yaml",
                    "Configurations of cases, of any head (ct_head.yaml) and of the sample (sample.yaml), and their "
                    "scenes; PREFIX is /usr for the Debian package."},
                   {"PREFIX/share/trephine/pipelines/*.yaml", "How each anatomy is made."},
                   {"PREFIX/share/trephine/sample_dicom/", "The CT series of a synthetic head."},
                   {"PREFIX/share/doc/trephine/", "README.md, the reference of all parameters, the format of a case."},
                   {"LIBRARY/.trephine-cache/",
                    "Outputs of stages that a later run reuses; it holds patient data as LIBRARY does."}};
  program.more_reference_pages = [] {
    return std::vector<std::pair<std::string, std::string>>{{"recipe.schema.json", recipe_schema()}};
  };
  return program;
}

}  // namespace
}  // namespace trephine

int main(int argc, char** argv) { return trephine::run_program("trephine", trephine::declare, argc, argv); }
