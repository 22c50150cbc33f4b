// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "base/progress.h"
#include "grid/grid.h"
#include "surface/trimesh.h"
#include "voxel/haptic_volume.h"

namespace trephine::page {

/// Surfaces and volumes as a page holds them (docs/reference/case-page.md): small, and quick to decode in a browser. A
/// page is to be looked at; the case's own files stay what is computed with.

/// The points are numbered anew in the order in which the triangles first use them. Varints (7 bits a byte, lowest
/// first): for each corner of a triangle how far back its point is (0: the next new one); then for each point and
/// coordinate the zigzag difference of its 16-bit position in the box to that of the point before; then, where there
/// are deviations, one signed byte a point: round(127 d / scale), or -128 where none is known.
struct PackedSurface {
  std::string bytes;
  std::uint64_t points = 0, triangles = 0;
  Vec3 min_mm, size_mm;           ///< LPS; position k is min + q / 65535 * size
  double deviation_scale_mm = 0;  ///< the largest |deviation|; 0: there are none, or all are 0
  double deviation_p99_mm = 0;    ///< 99 of 100 points deviate at most by this
  bool has_deviation = false;
};
/// `deviation_mm` is empty, or one value a point of the mesh, NaN where none is known. Positions are off by at most
/// size / 131070. Throws Error 65 as check_mesh does, 70 where the deviations are not as many as the points.
PackedSurface pack_surface(const surface::TriMesh& mesh, const std::vector<float>& deviation_mm = {});

/// A volume along the patient's axes, 8 bits a voxel, x (towards the left) fastest.
struct PackedVolume {
  grid::Lattice lattice;  ///< direction: identity
  std::string bytes;
};
constexpr int page_volume_side = 256;

/// HU in 256 levels: level (first) at HU (second), linear in between: steps of 2 HU from -160 to 160, coarser beyond.
constexpr std::array<std::array<int, 2>, 4> page_hu_levels = {{{0, -1024}, {24, -160}, {184, 160}, {255, 3071}}};

/// The CT on at most `side` voxels a side (at most page_volume_side): means of the old voxels where there are more. A
/// volume that lies oblique to the patient's axes is resampled (trilinear); what it does not cover is level 0.
PackedVolume pack_ct(const grid::Grid<std::int16_t>& volume, int side = page_volume_side,
                     const Progress& progress = {});
/// Each voxel's byte less what its neighbours in the slice predict, modulo 256: the median of left, above, and left +
/// above - above left [Weinberger2000], with 0 beyond the border. gzip makes a CT's slices a fifth to a third smaller.
std::string predicted_bytes(const PackedVolume& volume);
struct PackedShapes {
  PackedVolume numbers;  ///< of the shape that a voxel names (0: none), taken at the voxel's centre
  /// Encoding `occupancy`: a byte a voxel, how much of 255 that shape fills, in steps of 17, and then, again for all
  /// voxels, the number of the shape that fills the rest (voxel/voxel_shapes.h). Encoding `hu`: empty.
  std::string shares;
};
PackedShapes pack_shapes(const voxel::HapticVolume& volume, const Progress& progress = {});

/// The surface of a felt shape for a page: contoured on voxels so large that it has about `triangles`. Thin walls may
/// open. Empty where the shape fills no voxel of that size.
surface::TriMesh felt_surface_for_page(const voxel::HapticVolume& volume, int number, std::uint64_t triangles = 60000,
                                       const Progress& progress = {});

}  // namespace trephine::page
