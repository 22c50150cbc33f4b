// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <variant>
#include <vector>

#include "base/progress.h"
#include "base/result.h"
#include "surface/distance_function.h"
#include "surface/trimesh.h"
#include "voxel/haptic_volume.h"

namespace trephine::voxel {

/// What was removed of a shape (by shape_volume_mm3).
struct Removed {
  double removed_mm3 = 0;
  template <class V>
  static void describe(V& v) {
    v.number(&Removed::removed_mm3, "removed_mm3", Range{}, "Volume removed.");
  }
};

struct CutVolumeResult {
  Named<Removed> shapes;         ///< that are cut
  std::size_t voxels_count = 0;  ///< that changed
  template <class V>
  static void describe(V& v) {
    v.map(&CutVolumeResult::shapes, "shapes", "By shape.").items_alone();
    v.integer(&CutVolumeResult::voxels_count, "voxels_count", Range{}, "Voxels that changed.");
  }
};

/// Cuts a solid, given by its signed distance (positive outside) and bounds, out of the shapes with these numbers (of
/// all shapes where empty). Their occupancy is lowered to what the solid leaves, with the same sub-voxel surface as in
/// voxelize, and a voxel below 1/255 becomes EMPTY.
///
/// The occupancy of a shape rises in no voxel, and therefore nowhere under trilinear interpolation; a voxel that was
/// cut never reads as another shape. A voxel of two shapes keeps the larger share where the other one cannot be kept
/// beside it. Voxels beside the cut become bare where their rest would go to another shape than before.
///
/// Encoding `hu`: voxels of the windows within the solid become -1024 (all voxels, where all shapes are cut). Where no
/// voxel of another window is near, those on the ramp get HU that put the surface where the solid's is (for windows
/// above the lowest it may lie up to (low - lowest low) / (low + 1024) of a voxel farther from the solid), but never a
/// value of another window. No voxel reads as a shape that it was not before.
///
/// A servo may read and drill the same voxels meanwhile: each is replaced only as it was read, so none rises.
///
/// A warning where nothing is removed from any of the shapes.
Outcome<std::monostate, CutVolumeResult> cut_volume(HapticVolume& volume, const surface::DistanceFunction& solid,
                                                    const surface::Bounds& solid_bounds_mm,
                                                    const std::vector<int>& shape_numbers,
                                                    const Progress& progress = {});

/// The volume that a shape fills, with its shares of voxels of two shapes. A voxel with occupancy o counts as clamp(1/2
/// + 2 (o - 1/2), 0, 1), because the ramp of occupancy is twice as wide as a voxel's share of a plane; otherwise a ball
/// of radius R voxels would be measured (ramp / R)^2 too large. Encoding `hu`: the voxels in its window.
double shape_volume_mm3(const HapticVolume& volume, int number);

struct CutFieldResult {
  std::size_t voxels_count = 0;  ///< that changed
  std::optional<double> unit_per_mm;
  template <class V>
  static void describe(V& v) {
    v.integer(&CutFieldResult::voxels_count, "voxels_count", Range{}, "Voxels that changed.");
    v.number(&CutFieldResult::unit_per_mm, "unit_per_mm", "The field's unit near its surface.");
  }
};

/// Cuts a solid out of a field (positive inside): the field becomes the smaller of itself and the cutter's distance, in
/// the field's own unit near its surface (the median length of its gradient there), up to three voxels from the solid.
/// The result is positive inside the rest and finite everywhere. A warning where no voxel inside is lowered.
Outcome<std::monostate, CutFieldResult> cut_field(grid::Field& field, const surface::DistanceFunction& solid,
                                                  const surface::Bounds& solid_bounds_mm,
                                                  const Progress& progress = {});

}  // namespace trephine::voxel
