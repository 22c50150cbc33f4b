// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <functional>
#include <list>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/progress.h"
#include "cases/case.h"
#include "grid/grid.h"
#include "surface/trimesh.h"
#include "voxel/haptic_volume.h"

namespace trephine::publish {

struct PictureAnatomy {
  std::string name;
  const surface::TriMesh* surface = nullptr;
  std::array<double, 3> colour_rgb{0.8, 0.8, 0.8};
  double opacity = 1;
};

struct CasePicture {
  std::string name;  ///< overview.png
  std::string png;   ///< the file's bytes
};

/// The pictures that a technician looks at before a case is used: overview.png (everything on one page), axial.png,
/// coronal.png and sagittal.png (the CT with the exact cuts of the surfaces); and two of the overview by themselves, by
/// which a library shows the case: cut.png (all surfaces, cut open) and middle.png (an axial slice). Where there are
/// landmarks, landmarks.png shows them as balls of 3 mm on the largest shape, greener with more confidence, and the
/// slices through each. The pictures are made in memory, so that they can be written when nothing can fail any more.
/// Without a volume there are only those of surfaces, without anatomies only those of the volume. The same input gives
/// the same bytes.
std::vector<CasePicture> make_case_pictures(const grid::HuVolume* volume, const std::vector<PictureAnatomy>& anatomies,
                                            const std::vector<cases::CaseLandmark>& landmarks,
                                            const Progress& progress = {});

/// The ball that stands for a landmark in pictures, within so much of a round one.
surface::TriMesh ball_at(Vec3 position_mm, double within_mm);

/// Adds to `shown` the shapes that are felt and have no surface of their own, as the simulator will show them: capped
/// where the volume ends. `kept` holds their surfaces.
void show_felt(const cases::CaseManifest& manifest, const voxel::HapticVolume& haptic,
               std::list<surface::TriMesh>& kept, std::vector<PictureAnatomy>& shown, const Progress& progress = {});

/// Of each anatomy <anatomy>_sides.png: its surface from six sides.
std::vector<CasePicture> make_side_pictures(const std::vector<PictureAnatomy>& anatomies,
                                            const Progress& progress = {});

/// A scan that is read back from disk whenever it is looked at, so that no two need be held at a time.
using ScanOnce = std::function<std::shared_ptr<const grid::HuVolume>()>;

/// What a stage took off the scan: removed_by_NAME.png, slices of the scan before with the outline of what is missing
/// after, which has at least 0.5 ml. Nothing where less is missing. Both volumes have the same lattice (Error 70).
std::optional<CasePicture> make_removed_picture(const ScanOnce& before, const ScanOnce& after, const std::string& name,
                                                const Progress& progress = {});

}  // namespace trephine::publish
