// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "base/progress.h"
#include "grid/grid.h"
#include "surface/trimesh.h"

namespace trephine {

struct PictureAnatomy {
  std::string name;
  const TriMesh* surface = nullptr;
  std::array<double, 3> colour_rgb{0.8, 0.8, 0.8};
  double opacity = 1;
};

/// What a technician looks at before a case is used, as PNG through the checked writer: overview.png (all of it on a
/// page), <anatomy>.png (one surface from several sides), axial.png, coronal.png, sagittal.png (the CT with the
/// surfaces' exact cuts). The same bytes for the same input.
void write_case_pictures(const std::filesystem::path& folder, const HuVolume& volume,
                         const std::vector<PictureAnatomy>& anatomies, const Progress& progress = {});

}  // namespace trephine
