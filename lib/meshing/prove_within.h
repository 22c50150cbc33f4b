// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "surface/triangle_tree.h"
#include "surface/trimesh.h"

namespace trephine::meshing {

/// A place on one surface and where the other lies.
struct NearbyPlace {
  Vec3 at;
  double distance = 0;         ///< upper bound of the distance to the other surface
  std::uint32_t near = 0;      ///< where the search starts; its meaning is the caller's
  std::uint32_t triangle = 0;  ///< a triangle of the other surface, nearby
};

/// Proves, without sampling, that no point of a triangle lies further than the limit from the surface `to`. Two
/// arguments are used. The distance to a surface is 1-Lipschitz, and no point of a triangle is further from all its
/// corners than the longest side divided by the root of 3. The distance to one triangle is convex, and so largest at a
/// corner. Where neither is enough, the triangle is cut in four. The distance of a new corner is that to its
/// neighbours' triangles where that leaves much of the limit; otherwise look(place) may find a nearer triangle. Returns
/// false where the proof fails or would take too many pieces. `stack` is working memory.
template <class Look>
bool proven_within(const std::array<NearbyPlace, 3>& corners, double limit, const surface::TriMesh& to,
                   const Look& look, std::vector<std::array<NearbyPlace, 3>>& stack) {
  constexpr std::size_t max_pieces = 1000;
  constexpr double enough = 0.6;
  const auto reach = [&](Vec3 p, std::uint32_t t) {
    const auto& v = to.triangles[t];
    return norm(p - surface::closest_on_triangle(p, to.points_mm[v[0]], to.points_mm[v[1]], to.points_mm[v[2]]));
  };
  stack.assign(1, corners);
  for (std::size_t pieces = 0; !stack.empty(); ++pieces) {
    const std::array<NearbyPlace, 3> t = stack.back();
    stack.pop_back();
    const double farthest = std::max({t[0].distance, t[1].distance, t[2].distance});
    if (!(farthest <= limit) || pieces > max_pieces) return false;
    const Vec3 side[3] = {t[1].at - t[0].at, t[2].at - t[1].at, t[0].at - t[2].at};
    const double longest2 = std::max({dot(side[0], side[0]), dot(side[1], side[1]), dot(side[2], side[2])});
    if (3 * (limit - farthest) * (limit - farthest) >= longest2) continue;
    bool convex = false;
    for (int c = 0; c < 3 && !convex; ++c) {
      if ((c > 0 && t[c].triangle == t[0].triangle) || (c == 2 && t[2].triangle == t[1].triangle)) continue;
      convex = true;
      for (int k = 0; k < 3 && convex; ++k) convex = reach(t[k].at, t[c].triangle) <= limit;
    }
    if (convex) continue;
    std::array<NearbyPlace, 3> middle;
    for (int c = 0; c < 3; ++c) {
      const NearbyPlace &a = t[c], &b = t[(c + 1) % 3];
      const Vec3 at = (a.at + b.at) / 2;
      const double to_a = reach(at, a.triangle), to_b = b.triangle == a.triangle ? to_a : reach(at, b.triangle);
      middle[c] = to_b < to_a ? b : a;
      middle[c].at = at;
      middle[c].distance = std::min(to_a, to_b);
      if (middle[c].distance > enough * limit) look(middle[c]);
    }
    stack.push_back({t[0], middle[0], middle[2]});
    stack.push_back({middle[0], t[1], middle[1]});
    stack.push_back({middle[2], middle[1], t[2]});
    stack.push_back({middle[0], middle[1], middle[2]});
  }
  return true;
}

}  // namespace trephine::meshing
