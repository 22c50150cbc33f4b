// SPDX-License-Identifier: GPL-3.0-or-later
#include "itk/registration.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/write_file.h"
#include "cli/argument.h"
#include "cli/command.h"
#include "itk/transform_file.h"
#include "picture/slice.h"
#include "stage_command.h"
#include "stages/data_files.h"

namespace trephine::tools {
namespace {

constexpr int square_px = 40, side_px = 640;

// The window of grey values in which the middle 98 % of a scan's tissue is seen.
picture::SliceParams window_of(const grid::HuVolume& volume, bool is_hu) {
  picture::SliceParams p;
  p.longer_side_px = side_px;
  p.marks = false;
  if (is_hu) return p;
  std::visit(
      [&](const auto& grid) {
        std::vector<double> some;
        for (std::size_t i = 0; i < grid.voxels.size(); i += 97) some.push_back(double(grid.voxels[i]));
        std::sort(some.begin(), some.end());
        const double low = some[some.size() / 100], high = some[some.size() - 1 - some.size() / 100];
        p.window_center_hu = (low + high) / 2;
        p.window_width_hu = std::max(1e-6, high - low);
      },
      volume);
  return p;
}

// The voxels above a value as a field, of which a slice shows the outline.
grid::Field above(const grid::HuVolume& volume, float value) {
  return std::visit(
      [&](const auto& grid) {
        grid::Field field(static_cast<const grid::Lattice&>(grid));
        for (std::size_t i = 0; i < grid.voxels.size(); ++i)
          field.voxels[i] = static_cast<float>(grid.voxels[i]) - value;
        return field;
      },
      volume);
}

// Three slices through the middle: a checkerboard of both scans, and the second scan with the CT's bone and skin on it.
picture::Image overlay_picture(const grid::HuVolume& ct, const grid::HuVolume& second, bool second_is_hu) {
  const grid::Field bone = above(ct, 226), skin = above(ct, -300);
  const grid::Lattice& lattice = grid::lattice_of(ct);
  const Vec3 middle =
      lattice.to_world_mm({(lattice.size[0] - 1) / 2.0, (lattice.size[1] - 1) / 2.0, (lattice.size[2] - 1) / 2.0});
  std::vector<picture::Image> cells;
  for (const picture::SlicePlane plane :
       {picture::SlicePlane::axial, picture::SlicePlane::coronal, picture::SlicePlane::sagittal}) {
    picture::SliceParams p = window_of(ct, true), q = window_of(second, second_is_hu);
    p.plane = q.plane = plane;
    p.position_mm = q.position_mm = plane == picture::SlicePlane::axial     ? middle.z
                                    : plane == picture::SlicePlane::coronal ? middle.y
                                                                            : middle.x;
    picture::Image board = picture::slice_overlay(ct, p, {});
    const picture::Image other = picture::slice_overlay(second, q, {});
    for (int y = 0; y < board.height; ++y)
      for (int x = 0; x < board.width; ++x)
        if ((x / square_px + y / square_px) % 2) std::copy_n(other.at(x, y), 3, board.at(x, y));
    cells.push_back(std::move(board));
    q.marks = true;
    cells.push_back(picture::slice_overlay(
        second, q,
        {{nullptr, {1, 0.8, 0.2}, "bone of the CT", &bone}, {nullptr, {0.3, 0.8, 1}, "skin of the CT", &skin}}));
  }
  return picture::contact_sheet(cells, 2);
}

itk::LinearMap map_of(const std::vector<double>& rows) {
  itk::LinearMap map;
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) map.matrix.column[k][i] = rows[static_cast<std::size_t>(4 * i + k)];
    map.offset_mm[i] = rows[static_cast<std::size_t>(4 * i + 3)];
  }
  return map;
}

}  // namespace

const cli::OwnCommand register_command([] {
  const stages::StageType& stage = stages::stage_named("register");
  cli::Command c = make_stage_command(stage);
  for (cli::Argument& a : c.arguments)
    if (a.name == "moving") a.positional = true;
  c.arguments.push_back(cli::argument(
      "transform", cli::Argument::Kind::out_file,
      "Write the transform, from the CT to the second scan, as 3D Slicer and ITK read it (.tfm, or .h5: HDF5)."));
  c.arguments.push_back(cli::argument(
      "picture", cli::Argument::Kind::out_file,
      "Write slices of both scans as a checkerboard, and with the CT's outlines (.png); also "
      "of a doubtful result, so that it can be seen what is wrong. It shows the face of whoever was scanned: keep it "
      "as you keep the scans."));
  c.run = [stage](const cli::ParsedCommand& parsed) {
    const auto& params = parsed.params<itk::RegistrationParams>();
    if (parsed.path("output").extension() != ".nrrd")
      throw Error(ExitCode::usage, parsed.text("output"), "output", "must end in .nrrd");
    if (parsed.has("transform") && !itk::is_transform_file(parsed.path("transform")))
      throw Error(ExitCode::usage, parsed.text("transform"), "transform", "must end in .tfm or .h5");
    run_with_report(parsed, [&](const Progress& progress) {
      const stages::StageInputs inputs = stage_inputs(stage, parsed);
      const auto picture = [&](const itk::LinearMap& map) {
        if (!parsed.has("picture")) return;
        const grid::HuVolume &ct = *inputs.get<grid::HuVolume>("volume"),
                             &moving = *inputs.get<grid::HuVolume>("moving");
        const bool is_hu = params.moving == itk::MovingValues::hu;
        const grid::HuVolume second = itk::resample_onto(moving, grid::lattice_of(ct), map, is_hu ? -1000.0f : 0.0f);
        write_file(parsed.path("picture"), picture::encode_png(overlay_picture(ct, second, is_hu)));
      };
      try {
        const stages::StageOutcome made = stage.run(parsed.groups[0], inputs, progress.part(0.1, 0.95));
        const itk::LinearMap map = map_of(result_as<itk::RegistrationFigures>(made.result).transform);
        picture(map);
        if (parsed.has("transform")) itk::write_transform(parsed.path("transform"), map);
        stages::save_data(parsed.path("output"), made.data);
        return made.report();
      } catch (const itk::DoubtfulRegistration& e) {
        picture(e.map());
        throw;
      }
    });
    return ExitCode::ok;
  };
  return c;
});

}  // namespace trephine::tools
