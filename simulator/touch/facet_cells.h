// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "surface/triangle_tree.h"

namespace trephine::touch {

/// Which facets of a mesh a short way may meet, by cells around the mesh: at once, where a tree is searched from its
/// root. Only the constructor allocates. Positions are the mesh's own, about its origin.
class FacetCells {
 public:
  /// `skin_mm` is how far from a way its facets may be.
  FacetCells(const surface::TriangleTree& tree, double skin_mm);
  bool known() const { return !first_.empty(); }  ///< else there would be too many, and the tree must be searched
  double reach_mm() const { return reach_mm_; }
  /// Calls look(place) for all facets whose boxes a way that begins there and is no longer than reach_mm() may come
  /// near, and for others, as places of the tree's order, ascending.
  template <class Look>
  void for_each(Vec3 begin_mm, const Look& look) const {
    const Vec3 at = (begin_mm - low_) * cells_per_mm_;
    if (!(at.x >= 0 && at.y >= 0 && at.z >= 0 && at.x < size_[0] && at.y < size_[1] && at.z < size_[2])) return;
    const std::size_t cell =
        (std::size_t(at.z) * std::size_t(size_[1]) + std::size_t(at.y)) * std::size_t(size_[0]) + std::size_t(at.x);
    for (std::uint32_t n = first_[cell]; n < first_[cell + 1]; ++n) look(facet_[n]);
  }

 private:
  bool fill(const surface::TriangleTree& tree, const surface::FloatBox& all, double skin_mm, double cell_mm);
  Vec3 low_;
  double cells_per_mm_ = 0, reach_mm_ = 0;
  std::array<int, 3> size_{};
  std::vector<std::uint32_t> first_, facet_;  // of each cell its first, and one more; all cells' facets
};

}  // namespace trephine::touch
