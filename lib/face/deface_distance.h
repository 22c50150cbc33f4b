// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "base/progress.h"
#include "face/deface.h"
#include "grid/grid.h"

namespace trephine::face {

/// Distances to a field's surface within a box. It keeps the points where the surface crosses the edges of the field's
/// raster, and a coarser lattice of nodes. Each node knows one of the nearest points (by vector sweeps
/// [Danielsson1980]), and a query looks for the nearest point around it.
class SkinDistance {
 public:
  /// `box` is in the field's indices and may reach beyond it. The nodes cover it at a distance of `step_mm`, or of the
  /// raster's spacing where that is more. Only crossings within the box are known.
  SkinDistance(const grid::Field& field, const grid::Box& box, double step_mm, const Progress& progress = {});

  const grid::Lattice& nodes() const { return nodes_; }
  bool empty() const { return points_.empty(); }
  /// The distance from a world point; 1e6 where the box holds no surface. It is never too small by more than the
  /// surface bends between neighbouring voxels; near 5 mm it is too large by at most error_mm(), because the points lie
  /// in the raster's planes.
  double distance_mm(Vec3 world_mm) const;
  double error_mm() const;
  /// The same, several times as fast, but up to loose_mm too large.
  double about_mm(Vec3 world_mm) const;
  static constexpr double loose_mm = 1;
  /// The signed distance at the nodes, positive where the field is; beyond the field is outside. Up to 0.3 steps too
  /// large.
  const grid::Grid<float>& signed_mm() const { return signed_; }
  /// How many voxels of the raster make a step of the nodes, and where the first node lies.
  const std::array<int, 3>& voxels() const { return voxels_; }

 private:
  std::int32_t guess(const std::array<float, 3>& at, Vec3 index) const;
  std::array<float, 3> local_mm(Vec3 index) const;
  void sort_points();
  double to_point_mm(const std::array<float, 3>& at, std::int32_t point) const;
  void offer(std::size_t node, int i, int j, int k, std::int32_t point);
  void find_points(const grid::Field& field, const grid::Box& box, const Progress& progress);
  void sweep(int direction, const Progress& progress);

  grid::Lattice nodes_;
  std::array<int, 3> voxels_{1, 1, 1};
  std::vector<std::array<float, 3>> points_;  ///< mm along the axes from node (0, 0, 0)
  std::vector<std::uint32_t> bucket_;  ///< of each node the first of the points in the cell above it, and the end
  std::vector<std::int32_t> nearest_;
  std::vector<float> distance_;
  grid::Grid<float> signed_;
};

/// The box of `lattice`'s voxels that may lie in the region grown by `margin_mm`; empty where none does.
grid::Box box_of(const FaceRegion& region, const grid::Lattice& lattice, double margin_mm);

}  // namespace trephine::face
