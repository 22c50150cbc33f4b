// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "surface/triangle_tree.h"

namespace trephine::touch {

/// How far a place is at least from the triangles of a mesh, known at once: by cells of half a millimetre or more,
/// around the mesh. Only the constructor allocates or throws. Positions are the mesh's own, about its origin.
class FarField {
 public:
  FarField(const surface::TriMesh& mesh, const surface::TriangleTree& tree);
  /// Never more than the distance, and 0 where that is not known to be more.
  double least_mm(Vec3 place_mm) const {
    const Vec3 at = (place_mm - low_) * cells_per_mm_;
    if (!(at.x >= 0 && at.y >= 0 && at.z >= 0 && at.x < size_[0] && at.y < size_[1] && at.z < size_[2]))
      return beyond_mm(at);
    return least_[(std::size_t(at.z) * std::size_t(size_[1]) + std::size_t(at.y)) * std::size_t(size_[0]) +
                  std::size_t(at.x)];
  }

 private:
  double beyond_mm(Vec3 cells) const;
  Vec3 low_;
  double cell_mm_, cells_per_mm_;
  std::array<int, 3> size_{};
  std::vector<float> least_;
};

}  // namespace trephine::touch
