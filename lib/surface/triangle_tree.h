// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
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

  /// Calls visit(leaf), nearest first by bound(box), which is never more than the square of their distance, for leaves
  /// whose bound is below the limit; visit() may lower it.
  template <class Bound, class Visit>
  void visit_nearest(const double& squared_limit, const Bound& bound, const Visit& visit) const;

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

template <class Bound, class Visit>
void TriangleTree::visit_nearest(const double& squared_limit, const Bound& bound, const Visit& visit) const {
  struct Entry {
    double d2;
    int level;
    std::size_t node;
  };
  std::array<Entry, 64> stack;
  int top = 0;
  if (!order_.empty()) stack[top++] = {0, static_cast<int>(levels_.size()) - 1, 0};
  while (top > 0) {
    const Entry e = stack[--top];
    if (e.d2 >= squared_limit) continue;
    if (e.level == 0) {
      visit(e.node);
      continue;
    }
    const auto& level = levels_[e.level - 1];
    std::array<Entry, width> child;
    int children = 0;
    for (std::size_t c = width * e.node; c < std::min(width * (e.node + 1), level.size()); ++c) {
      const double d2 = bound(level[c]);
      if (d2 >= squared_limit) continue;
      int at = children++;  // the nearest ends on top of the stack
      for (; at > 0 && child[at - 1].d2 < d2; --at) child[at] = child[at - 1];
      child[at] = {d2, e.level - 1, c};
    }
    for (int c = 0; c < children; ++c) stack[top++] = child[c];
  }
}

}  // namespace trephine::surface
