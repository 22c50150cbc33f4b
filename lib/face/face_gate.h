// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <variant>
#include <vector>

#include "base/progress.h"
#include "base/result.h"
#include "face/deface.h"
#include "grid/grid.h"
#include "surface/trimesh.h"
#include "voxel/haptic_volume.h"

namespace trephine::face {

/// What is about to be published. The pointers are used only while the check runs.
struct FaceSurface {
  std::string name;
  const surface::TriMesh* mesh = nullptr;
};
struct FaceVolume {
  std::string name;
  std::variant<const grid::Grid<std::int16_t>*, const grid::Grid<float>*, const grid::Mask*> grid;
  double empty_at_most = 0;  ///< values above this at the lattice's border count as a surface there
};
FaceVolume face_volume(const std::string& name, const grid::HuVolume& volume);
/// The voxels of a haptic volume; its hardness, where it has one, is a volume of its own (face_volume of a mask).
FaceVolume face_volume(const std::string& name, const voxel::HapticVolume& volume);
FaceVolume face_volume(const std::string& name, const grid::Mask& mask);

/// How near a published object comes to the original skin within the face region; the limit of the search where none
/// comes near.
struct FaceDistance {
  std::string name;
  double distance_mm = 0;
};
constexpr double face_search_mm = 15;

/// The distances for acceptance case P4. `original_skin` is the skin of the volume before its face was removed.
///
/// Surfaces: the least distance of all points of the triangles that lie in the region, to 0.1 mm. Volumes: every point
/// of a cell (the box between eight voxel centres) whose samples differ at all lies on the isosurface of some value.
/// Therefore the least distance of the points of such cells, to 0.25 mm, covers all isosurfaces of all values, noise
/// included. Distances are rounded down, so what is reported as clear is clear.
std::vector<FaceDistance> face_distances(const grid::Field& original_skin, const FaceRegion& region,
                                         const std::vector<FaceSurface>& surfaces,
                                         const std::vector<FaceVolume>& volumes, const Progress& progress = {});

struct FaceGateResult {
  double face_distance_mm = 0;  ///< the least distance of all, at most face_search_mm
  template <class V>
  static void describe(V& v) {
    v.number(&FaceGateResult::face_distance_mm, "face_distance_mm", Range{},
             "How near what is shown comes to the face.");
  }
};

/// The privacy gate of a face that is the union of these regions (face_regions). Throws Error 81, naming the nearest
/// object and its distance, where that is below face_clearance_mm.
FaceGateResult check_face_removed(const grid::Field& original_skin, const std::vector<FaceRegion>& regions,
                                  const std::vector<FaceSurface>& surfaces, const std::vector<FaceVolume>& volumes,
                                  const Progress& progress = {});

/// The skin that one scan of a case shows (face/scan_skin.h), in the case's frame.
struct ScanSkin {
  std::string scan;  ///< its name in the configuration
  grid::Field skin;
};

/// The same of every scan that the case reads: of two scans of one head, one may show a face that was taken off the
/// other before the case was made.
FaceGateResult check_face_removed(const std::vector<ScanSkin>& skins, const std::vector<FaceRegion>& regions,
                                  const std::vector<FaceSurface>& surfaces, const std::vector<FaceVolume>& volumes,
                                  const Progress& progress = {});

}  // namespace trephine::face
