// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "base/params.h"
#include "base/progress.h"
#include "base/result.h"
#include "grid/grid.h"
#include "surface/trimesh.h"
#include "voxel/cut.h"
#include "voxel/haptic_volume.h"

namespace trephine::voxel {

/// A shape of a haptic volume.
struct ShapeVoxels {
  double volume_ml = 0;  ///< what is left of it
  std::size_t voxels_count = 0;
  std::optional<double> overlap_ml;  ///< what went to earlier shapes
  template <class V>
  static void describe(V& v) {
    v.number(&ShapeVoxels::volume_ml, "volume_ml", Range{}, "Volume that is left of the shape.");
    v.integer(&ShapeVoxels::voxels_count, "voxels_count", Range{}, "Voxels of the shape.");
    v.number(&ShapeVoxels::overlap_ml, "overlap_ml", "What went to shapes of precedence.");
  }
};

struct VoxelizeResult {
  Named<ShapeVoxels> shapes;
  std::optional<std::int64_t> clamped_voxels_count;  ///< of raw HU: those beyond int16
  Named<CutVolumeResult> cutters;                    ///< where the volume was cut
  template <class V>
  static void describe(V& v) {
    using P = VoxelizeResult;
    v.map(&P::shapes, "shapes", "By shape.").items_alone();
    v.integer(&P::clamped_voxels_count, "clamped_voxels_count", "Voxels whose HU were clamped.");
    v.map(&P::cutters, "cutters", "What each cutter removed.").items_alone();
  }
};

/// One shape of the volume to be made. Earlier shapes of a list have precedence: a part that one fills does not belong
/// to later ones.
struct VoxelizeShape {
  std::string name;
  const surface::TriMesh* surface = nullptr;  ///< closed: the undecimated surface of the shape's field
  /// Nothing of this shape lies within clear_mm of the solid `clear_of`, except behind or within an earlier solid: the
  /// fluid between brain and skull does not become scalp, and the scalp outside a thin bone stays. Null: no such rule.
  const surface::TriMesh* clear_of = nullptr;
  double clear_mm = 0;
  /// Above 0, only what lies at most so deep below the surface belongs to the shape: a membrane around what is within.
  double shell_mm = 0;
  /// In place of the surface, where there is no shell: the shape's field, which takes a fifth of the time.
  const grid::Field* field = nullptr;
  /// The field's voxels that are on the other side than its value says (a cavity that is filled), by voxel; or empty.
  std::vector<bool> turned;
};

struct VoxelizeParams {
  std::array<double, 3> spacing_mm{0.8, 0.8, 0.8};
  double margin_mm = 10;
  std::array<double, 3> region_min_mm{-1e6, -1e6, -1e6}, region_max_mm{1e6, 1e6, 1e6};
  double hardness_low_hu = 0, hardness_high_hu = 0;
  double max_voxels_millions = 200;
  template <class V>
  static void describe(V& v) {
    using P = VoxelizeParams;
    v.numbers(&P::spacing_mm, "spacing_mm", Range{0.05, 10}, "Voxel size along the scan's own axes.");
    v.number(&P::margin_mm, "margin_mm", Range{0, 1000},
             "Margin on every side around the box of the shape that defines the region (or of all shapes).");
    v.numbers(&P::region_min_mm, "region_min_mm", Range{-1e6, 1e6},
              "Lower corner beyond which the region may not reach, LPS.");
    v.numbers(&P::region_max_mm, "region_max_mm", Range{-1e6, 1e6},
              "Upper corner beyond which the region may not reach, LPS.");
    v.number(&P::hardness_low_hu, "hardness_low_hu", Range{-32768, 32767},
             "HU of the softest material. If hardness_high_hu is above it, a hardness volume is made.");
    v.number(&P::hardness_high_hu, "hardness_high_hu", Range{-32768, 32767}, "HU of the hardest material.");
    v.number(&P::max_voxels_millions, "max_voxels_millions", Range{0.001, 2000},
             "Refuse more voxels than this, in millions.");
  }
};

/// The lattice along `direction` (the scan's) whose voxels cover the box `region_mm` (world bounds). Voxel centres lie
/// at whole multiples of the spacing from `anchor_mm`, so that a larger region has the same voxels. Throws Error 78
/// (field haptic.spacing_mm) where it would exceed max_voxels_millions.
grid::Lattice haptic_lattice(const surface::Bounds& region_mm, const Mat3& direction, Vec3 anchor_mm,
                             const VoxelizeParams& params);

/// Makes the haptic volume of the shapes, numbered from 1 in the given order. The occupancy of a voxel is 1/2 - d / (2
/// r), limited to 0 and 1, where d is the signed distance of its centre to the surface and r is the reach of its
/// neighbours along that direction n, sum |n_a| spacing_a. Therefore trilinear interpolation reproduces planes of every
/// direction (bias and RMS are in docs/validation/surfaces.md). A wall as thick as a voxel along its normal is felt
/// everywhere, a thinner one only where voxel centres lie well inside it.
///
/// A voxel keeps its largest share. It also keeps its second share where the neighbours' rule of haptic_volume.h gives
/// the rest to that shape and this is nearer to the truth than EMPTY. A gap of less than a quarter of a voxel between
/// two shapes closes. So no voxel reads as more than half of a shape that is not there.
///
/// The result has
/// the same bytes whatever the thread count. Throws Error 65 where a surface is not closed; 80 where a shape has at
/// least half of no voxel of the region (it could not be felt), because it is too thin, or because earlier shapes or
/// its clearance took it; Cancelled.
Outcome<HapticVolume, VoxelizeResult> voxelize(const grid::Lattice& lattice, const std::vector<VoxelizeShape>& shapes,
                                               const Progress& progress = {});

/// A shape as a window of HU, both ends included.
struct HuWindow {
  std::string name;
  std::int16_t low_hu = 0, high_hu = 0;
};
/// Makes a haptic volume of a raw CT: the HU resampled onto the lattice (trilinear; -1024 outside of the scan), rounded
/// and clamped to int16 (these are counted). Throws Error 78 where windows overlap, are empty or begin at -1024
/// or below.
Outcome<HapticVolume, VoxelizeResult> voxelize_hu(const grid::HuVolume& volume, const grid::Lattice& lattice,
                                                  const std::vector<HuWindow>& windows, const Progress& progress = {});

/// The hardness volume from the HU at each voxel: 0 at low_hu and below, 255 at high_hu and above (cancellous to
/// cortical bone).
grid::Mask haptic_hardness(const grid::HuVolume& volume, const grid::Lattice& lattice, double low_hu, double high_hu,
                           const Progress& progress = {});

}  // namespace trephine::voxel
