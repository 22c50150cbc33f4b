// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "base/error.h"
#include "base/joined.h"
#include "cli/argument.h"
#include "cli/command.h"
#include "grid/bounded_read.h"
#include "itk/volume_file.h"
#include "itk/volume_write.h"
#include "stage_command.h"
#include "voxel/haptic_file.h"

namespace trephine::tools {
namespace {

const char* sample_name(const grid::AnyGrid& grid) {
  constexpr const char* names[] = {"int16", "float32", "uint8"};
  return names[grid.index()];
}

Report convert(const cli::ParsedCommand& parsed, const Progress& progress) {
  const std::filesystem::path input = parsed.path("input");
  if (itk::has_ending(input, ".nrrd") && with_file(input.string(), [&] {
        try {
          return grid::read_nrrd_bounded(input, grid::labels_limit).keys.count(voxel::haptic_file_key) > 0;
        } catch (const Error&) {
          return false;  // another encoding, which ITK reads, or a fault that is told below
        }
      }))
    throw Error(ExitCode::usage, input.string(), "input",
                "is a haptic volume, whose values mean nothing to another program: convert a field of it");
  Report report;
  std::string format;
  std::vector<std::string> warnings;
  const grid::AnyGrid grid =
      itk::read_grid_file(input, &format, &warnings, progress.part(0, 0.5), parsed.text("analyze_axes"));
  itk::write_volume_file(parsed.path("output"), grid, progress.part(0.5, 1));
  const grid::Lattice& lattice = std::visit([](const auto& g) -> const grid::Lattice& { return g; }, grid);
  report.add("format", format);
  report.add("size", fmt::format("{}x{}x{}", lattice.size[0], lattice.size[1], lattice.size[2]));
  report.add("spacing_x_mm", lattice.spacing_mm.x);
  report.add("spacing_y_mm", lattice.spacing_mm.y);
  report.add("spacing_z_mm", lattice.spacing_mm.z);
  report.add("sample_type", sample_name(grid));
  for (const std::string& w : warnings) report.warn(w);
  return report;
}

}  // namespace

const cli::OwnCommand convert_command([] {
  using Kind = cli::Argument::Kind;
  cli::Command c;
  c.name = "convert";
  c.summary = "writes a volume, a field or labels in another program's format";
  c.description =
      "Reads a volume (NRRD, NIfTI, Analyze, MetaImage, GIPL, VTK image, MINC 2) and writes its voxels as they are, in "
      "the "
      "format "
      "that the output's ending says. Place and axes are kept, in each format's own convention, and the file is read "
      "back before it gets its name. GIPL and VTK images hold no directions, so only volumes along left, back and up "
      "are written so. Nothing else of the input is carried over: no name, date or comment. The values are not judged; "
      "`import` reads a CT into HU.";
  c.examples = {"trephine convert head.nrrd --output head.mnc", "trephine convert skull.nrrd --output skull.mha",
                "trephine convert painted.mha --output painted.nii.gz",
                "trephine convert old.hdr --analyze-axes LAS --output old.nii.gz"};
  cli::Argument input = cli::argument("input", Kind::in_file, "The volume.");
  cli::Argument output =
      cli::argument("output", Kind::out_file, "Where it goes (" + joined(itk::written_volume_endings()) + ").");
  input.positional = input.required = output.required = true;
  cli::Argument axes =
      cli::argument("analyze_axes", Kind::text,
                    "Of Analyze 7.5 (.hdr and .img), which does not say which side is left: the sides to which "
                    "its columns, rows and slices rise, as three letters, one of R and L, one of A and P, one "
                    "of S and I.");
  c.arguments = {input, output, axes, report_argument()};
  c.run = [](const cli::ParsedCommand& parsed) {
    run_with_report(parsed, [&](const Progress& progress) { return convert(parsed, progress); });
    return ExitCode::ok;
  };
  return c;
});

}  // namespace trephine::tools
