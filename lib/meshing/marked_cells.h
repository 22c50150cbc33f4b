// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "base/vec3.h"
#include "surface/trimesh.h"

namespace trephine::meshing {

/// A raster of cubes over a mesh, some of them marked: says, without looking at every one of them, whether anything
/// that was marked can lie near a triangle. Boxes stand for triangles, so it errs towards yes.
class MarkedCells {
 public:
  /// Over the mesh's bounds, none of them marked; side_mm is the cubes' least side.
  MarkedCells(const surface::TriMesh& mesh, double side_mm) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    Vec3 high{-infinity, -infinity, -infinity};
    low_ = Vec3{infinity, infinity, infinity};
    for (const Vec3 p : mesh.points_mm)
      for (int a = 0; a < 3; ++a) {
        low_[a] = std::min(low_[a], p[a]);
        high[a] = std::max(high[a], p[a]);
      }
    side_ = std::max({side_mm, (high.x - low_.x) / 400, (high.y - low_.y) / 400, (high.z - low_.z) / 400, 1e-9});
    for (int a = 0; a < 3; ++a) count_[a] = static_cast<int>((high[a] - low_[a]) / side_) + 1;
    marked_.assign(static_cast<std::size_t>(count_[0]) * count_[1] * count_[2], 0);
  }
  /// Marks the cells within reach_mm of the triangle.
  void mark(const std::array<Vec3, 3>& corners, double reach_mm) {
    visit(corners, reach_mm, [this](std::size_t cell) { return marked_[cell] = 1, false; });
  }
  /// Whether a cell at the triangle is marked.
  bool any(const std::array<Vec3, 3>& corners) const {
    return visit(corners, 0, [this](std::size_t cell) { return marked_[cell] != 0; });
  }

 private:
  /// The cells that the triangle's box meets; until one says true.
  template <class Visitor>
  bool visit(const std::array<Vec3, 3>& t, double reach_mm, const Visitor& visitor) const {
    int from[3], to[3];
    for (int a = 0; a < 3; ++a) {
      const auto cell = [&](double x) {
        return static_cast<int>(std::clamp(std::floor((x - low_[a]) / side_), 0.0, count_[a] - 1.0));
      };
      from[a] = cell(std::min({t[0][a], t[1][a], t[2][a]}) - reach_mm);
      to[a] = cell(std::max({t[0][a], t[1][a], t[2][a]}) + reach_mm);
    }
    for (int k = from[2]; k <= to[2]; ++k)
      for (int j = from[1]; j <= to[1]; ++j)
        for (int i = from[0]; i <= to[0]; ++i)
          if (visitor((static_cast<std::size_t>(k) * count_[1] + j) * count_[0] + i)) return true;
    return false;
  }

  Vec3 low_;
  double side_ = 1;
  int count_[3] = {1, 1, 1};
  std::vector<char> marked_;
};

}  // namespace trephine::meshing
