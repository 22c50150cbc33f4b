// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "surface/trimesh.h"

namespace trephine {

/// Axis-parallel box in float, rounded outwards.
struct FloatBox {
  std::array<float, 3> min{3e38f, 3e38f, 3e38f}, max{-3e38f, -3e38f, -3e38f};
  void add(Vec3 p);
  void add(const FloatBox& b);
  bool meets(const FloatBox& b) const {
    return min[0] <= b.max[0] && b.min[0] <= max[0] && min[1] <= b.max[1] && b.min[1] <= max[1] && min[2] <= b.max[2] &&
           b.min[2] <= max[2];
  }
  /// Squared distance from the point, 0 inside.
  double squared_distance(Vec3 p) const;
};

/// Closest point of a triangle (Ericson, Real-Time Collision Detection, 5.1.5).
inline Vec3 closest_on_triangle(Vec3 p, Vec3 a, Vec3 b, Vec3 c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = dot(ab, ap), d2 = dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return a;
  const Vec3 bp = p - b;
  const double d3 = dot(ab, bp), d4 = dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return b;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + ab * (d1 / (d1 - d3));
  const Vec3 cp = p - c;
  const double d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return c;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + ac * (d2 / (d2 - d6));
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
  const double s = 1 / (va + vb + vc);
  return a + ab * (vb * s) + ac * (vc * s);
}

/// Squared distance to a triangle, and whether its closest point lies on the side across from a (or at one of that
/// side's ends): then `across` is 1 where that is nearer to b, 2 where to c; else 0.
inline double squared_from_corner(Vec3 p, Vec3 a, Vec3 b, Vec3 c, int& across) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = dot(ab, ap), d2 = dot(ac, ap);
  const auto squared = [](Vec3 v) { return dot(v, v); };
  across = 0;
  if (d1 <= 0 && d2 <= 0) return squared(ap);
  const Vec3 bp = p - b;
  const double d3 = dot(ab, bp), d4 = dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return across = 1, squared(bp);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return squared(ap - ab * (d1 / (d1 - d3)));
  const Vec3 cp = p - c;
  const double d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return across = 2, squared(cp);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return squared(ap - ac * (d2 / (d2 - d6)));
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const double t = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    across = t < 0.5 ? 1 : 2;
    return squared(bp - (c - b) * t);
  }
  const double s = 1 / (va + vb + vc);
  return squared(ap - ab * (vb * s) - ac * (vc * s));
}

/// Boxes over a mesh's triangles, sorted along a Morton curve, four to a leaf and four children to a node. Refers to
/// the mesh: it must not change meanwhile. Coordinates are points_mm, without the origin.
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

  /// Squared distance to the surface, and the triangle there; gives up (returning the limit) beyond squared_limit.
  double squared_distance(Vec3 p, double squared_limit, std::uint32_t* triangle = nullptr) const;

 private:
  const TriMesh& mesh_;
  std::vector<std::uint32_t> order_;
  std::vector<FloatBox> boxes_;
  std::vector<std::vector<FloatBox>> levels_;  ///< 0: leaves; the last has one node
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

}  // namespace trephine
