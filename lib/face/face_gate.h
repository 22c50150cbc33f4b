// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <variant>
#include <vector>

#include "base/progress.h"
#include "base/report.h"
#include "face/deface.h"
#include "grid/grid.h"
#include "surface/trimesh.h"
#include "voxel/haptic_volume.h"

namespace trephine {

/// What is about to be published. The pointers are only looked through while the gate runs.
struct FaceSurface {
  std::string name;
  const TriMesh* mesh = nullptr;
};
struct FaceVolume {
  std::string name;
  std::variant<const Grid<std::int16_t>*, const Grid<float>*, const Mask*> grid;
  double empty_at_most = 0;  ///< what ends at the lattice's border above this value has a surface there
};
FaceVolume face_volume(const std::string& name, const HuVolume& volume);
/// Its voxels; its hardness, where it has one, is a volume of its own (face_volume of a mask).
FaceVolume face_volume(const std::string& name, const HapticVolume& volume);
FaceVolume face_volume(const std::string& name, const Mask& mask);

/// How near a published thing comes to the original skin within the face region. The limit of search where nothing
/// does.
struct FaceDistance {
  std::string name;
  double distance_mm = 0;
};
constexpr double face_search_mm = 15;

/// Acceptance P4. `original_skin` is the skin of the volume before its face was removed.
///
/// Surfaces: the least distance of all of the triangles' points that lie in the region, to 0.1 mm. Volumes: every point
/// of a cell (the box between eight voxel centres) whose samples differ at all is on the isosurface of some value; so
/// the least distance of such cells' points, to 0.25 mm, is that of all isosurfaces of all values, noise included.
/// Distances are rounded down: what is reported as clear is clear.
std::vector<FaceDistance> face_distances(const Field& original_skin, const FaceRegion& region,
                                         const std::vector<FaceSurface>& surfaces,
                                         const std::vector<FaceVolume>& volumes, const Progress& progress = {});

/// The gate: throws Error 81 naming what comes nearest and its distance where that is below face_clearance_mm. The
/// report: face_distance_mm, the least of all (at most face_search_mm).
void check_face_removed(const Field& original_skin, const FaceRegion& region, const std::vector<FaceSurface>& surfaces,
                        const std::vector<FaceVolume>& volumes, Report& report, const Progress& progress = {});

}  // namespace trephine
