// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "surface/float_box.h"
#include "surface/point_triangle.h"
#include "surface/trimesh.h"

namespace trephine::surface {

/// Boxes over a mesh's triangles, sorted along a Morton curve, with four triangles in a leaf and four children of a
/// node. It refers to the mesh, which must not change meanwhile. Coordinates are points_mm, without the origin.
class TriangleTree {
 public:
  explicit TriangleTree(const TriMesh& mesh);

  static constexpr int width = 4;
  /// order()[width * leaf ... ] are the triangles of a leaf.
  const std::vector<std::uint32_t>& order() const { return order_; }
  std::size_t leaves() const { return levels_.front().size(); }
  const FloatBox& leaf_box(std::size_t leaf) const { return levels_.front()[leaf]; }
  /// The box of triangle order()[n].
  const FloatBox& box(std::size_t n) const { return boxes_[n]; }

  /// Calls visit(leaf) for the leaves from first_leaf on whose box meets `box`.
  template <class Visit>
  void for_each_leaf(const FloatBox& box, std::size_t first_leaf, Visit&& visit) const;

  /// Squared distance to the surface, and the nearest triangle; stops beyond squared_limit and returns that limit.
  double squared_distance(Vec3 p, double squared_limit, std::uint32_t* triangle = nullptr) const;

 private:
  const TriMesh& mesh_;
  std::vector<std::uint32_t> order_;
  std::vector<FloatBox> boxes_;
  std::vector<std::vector<FloatBox>> levels_;  ///< level 0: leaves; the last level has one node
};

template <class Visit>
void TriangleTree::for_each_leaf(const FloatBox& box, std::size_t first_leaf, Visit&& visit) const {
  struct Entry {
    int level;
    std::size_t node;
  };
  std::array<Entry, 64> stack;
  int top = 0;
  stack[top++] = {static_cast<int>(levels_.size()) - 1, 0};
  while (top > 0) {
    const Entry e = stack[--top];
    if (!levels_[e.level][e.node].meets(box)) continue;
    if (e.level == 0) {
      visit(e.node);
      continue;
    }
    const auto& below = levels_[e.level - 1];
    const std::size_t begin = width * e.node, end = std::min(begin + width, below.size());
    for (std::size_t c = end; c-- > begin;) {
      const std::size_t last_leaf = ((c + 1) << (2 * (e.level - 1))) - 1;
      if (last_leaf >= first_leaf) stack[top++] = {e.level - 1, c};
    }
  }
}

}  // namespace trephine::surface
