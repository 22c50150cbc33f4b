// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <vector>

#include "surface/trimesh.h"

namespace trephine::surface {

/// Whether points lie inside a closed surface, by the parity of what lies above them, as voxelize_inside has
/// it. Each edge decides once for both its triangles on which side of a point it passes, so that no point leaks.
class InsideQuery {
 public:
  explicit InsideQuery(const TriMesh& mesh);
  bool inside(Vec3 world_mm) const;

 private:
  std::size_t cell_of(double x, double y) const;

  std::vector<Vec3> points_;  ///< world
  std::vector<std::array<std::uint32_t, 3>> triangles_;
  Bounds bounds_;
  int across_ = 1, along_ = 1;
  double cell_mm_ = 1;
  std::vector<std::uint32_t> first_, listed_;  ///< of each cell of the raster in x and y, the triangles that reach in
};

}  // namespace trephine::surface
