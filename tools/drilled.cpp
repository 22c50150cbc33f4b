// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <iostream>

#include "ambf/adf.h"
#include "base/error.h"
#include "base/write_file.h"
#include "cli/argument.h"
#include "cli/command.h"
#include "cli/progress_display.h"
#include "export_parts.h"
#include "stage_command.h"
#include "stages/data_files.h"
#include "voxel/drilled.h"

namespace trephine::tools {
namespace {

std::string table_of(const ambf::DrilledLabels& drilled, double voxel_mm3, Report& report) {
  std::string out = "shape                     voxels     removed          mm3\n";
  std::size_t all = 0;
  for (const ambf::DrilledLabels::Shape& s : drilled.shapes) {
    const double mm3 = double(s.removed) * voxel_mm3;
    out += fmt::format("{:<20} {:>11} {:>11} {:>12.1f}\n", s.name, s.voxels, s.removed, mm3);
    report.add(s.name + ".voxels_count", s.voxels);
    report.add(s.name + ".removed_count", s.removed);
    report.add(s.name + ".removed_mm3", mm3);
    all += s.removed;
  }
  report.add("removed_mm3", double(all) * voxel_mm3);
  return out;
}

std::string run_drilled(const cli::ParsedCommand& parsed, Report& report, const Progress& progress) {
  const cases::LoadedCase loaded = cases::load_case(parsed.path("case"));
  if (!loaded.has_haptic())
    throw Error(ExitCode::bad_input, parsed.text("case"), "haptic",
                "the case holds no haptic volume, so that no stack is of it");
  const grid::Mask shown = voxel::shown_shapes(loaded.haptic);
  const grid::Mask now =
      ambf::read_stack(parsed.path("stack"), shown, ambf::palette_of(loaded.manifest), progress.part(0.1, 0.9));
  const ambf::DrilledLabels drilled = ambf::drilled_labels(loaded.haptic, shown, now);
  write_file(parsed.path("out"), grid::encode_labels(drilled.labels));
  const Vec3 v = loaded.haptic.voxels.spacing_mm;
  return table_of(drilled, v.x * v.y * v.z, report);
}

}  // namespace

const cli::OwnCommand drilled_command([] {
  using Kind = cli::Argument::Kind;
  cli::Command c;
  c.name = "drilled";
  c.summary = "reads a stack of pictures back that was drilled in volumetric_drilling, as labels";
  c.description =
      "Takes the pictures that volumetric_drilling saved after drilling (Ctrl+L) in a case that `trephine export "
      "--format ambf` gave it, and writes labels on the voxels of the case's haptic volume (NRRD, segments as 3D "
      "Slicer "
      "names them): what is left of each shape under its name and number, and what was removed of it as NAME_removed. "
      "`trephine-sim score-drilled` judges them by a lesson's rubric. Pictures that show anything else than the case's "
      "own voxels, there or removed, are refused (65).";
  c.arguments = {cli::positional_argument("case", Kind::in_folder, "Folder of the case."),
                 cli::positional_argument("stack", Kind::in_folder, "Folder of the pictures."),
                 cli::required_argument("out", Kind::out_file, "The labels (.seg.nrrd)."), report_argument()};
  c.examples = {"trephine drilled library/head-01 ADF/head-01.ambf/drilled --out drilled.seg.nrrd"};
  c.run = [](const cli::ParsedCommand& parsed) {
    Report report;
    std::string text;
    {
      cli::ProgressDisplay display(parsed.quiet);
      text = run_drilled(parsed, report, display.start("drilled"));
      display.finish("drilled", "");
    }
    if (parsed.has("report")) write_file(parsed.path("report"), stages::report_json(report));
    if (!parsed.quiet) std::cout << text;
    return ExitCode::ok;
  };
  return c;
});

}  // namespace trephine::tools
