// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/progress.h"
#include "grid/labels.h"
#include "meshio/export_mesh.h"
#include "voxel/haptic_volume.h"

namespace trephine::ambf {

/// A haptic volume as a stack of pictures, as volumetric_drilling takes it
/// (github.com/LCSR-SICKKIDS/volumetric_drilling) and saves it after drilling (its pull request 23, Ctrl+L): PNG of
/// RGBA, one a slice, PREFIX0.png, PREFIX1.png, ... A voxel is there where its alpha is 255, and 0 0 0 0 where it is
/// empty or was removed. CHAI3D, which reads them, counts rows from the bottom: the pixel in column i and row r lies at
/// voxel (i, height - 1 - r).

constexpr const char *stack_folder = "volume", *stack_prefix = "plane00";
std::string picture_name(std::size_t slice);

using Rgb = std::array<std::uint8_t, 3>;
/// The colour of each shape that `shown` may hold, by number; [0] is not used.
using Palette = std::vector<Rgb>;
/// What volumetric_drilling takes for bone: whatever has another colour is "critical" when it is drilled.
constexpr Rgb drilled_rgb{255, 249, 219};

/// The pictures of what each voxel shows (voxel::shown_shapes), in the order of the slices along the stack's third
/// axis: that of the lattice, or against it where the lattice is left-handed, for the simulator's frame is
/// right-handed.
std::vector<meshio::ExportFile> encode_stack(const grid::Mask& shown, const Palette& palette);

/// Which voxels a stack shows now, on the lattice of `shown`: 1 or 0. The files are pictures of a stranger, so that
/// they are decoded in a bounded child (base/child.h) by libpng. Numbers at the end of the files' names order them.
/// Throws Error 66 where there is no such folder; 65 naming the file where there are others than one for each slice, or
/// one is no PNG, has another size, or a pixel has another colour than `shown` has there: it is of another case, or was
/// not saved without loss.
grid::Mask read_stack(const std::filesystem::path& folder, const grid::Mask& shown, const Palette& palette,
                      const Progress& progress = {});

/// A drilled stack as labels on the haptic volume's voxels: what is left of each shape has its number and its name, and
/// what was removed of it 32 more, and the name with "_removed" (removed_suffix).
struct DrilledLabels {
  grid::LabelFile labels;
  struct Shape {
    std::string name;
    std::size_t voxels = 0, removed = 0;
  };
  std::vector<Shape> shapes;
};
DrilledLabels drilled_labels(const voxel::HapticVolume& volume, const grid::Mask& shown, const grid::Mask& now);

}  // namespace trephine::ambf
