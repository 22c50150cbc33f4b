// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/carried_points.h"

#include <algorithm>
#include <limits>

#include "meshing/triangle_tree.h"

namespace trephine {
namespace {

constexpr std::uint32_t none = CollapseMesh::none;

/// Calls visit(triangle) for the triangles around u or v, each once.
template <class Visit>
void for_each_around(const CollapseMesh& mesh, std::uint32_t u, std::uint32_t v, Visit&& visit) {
  mesh.for_each_leaving(u, [&](std::uint32_t e) { visit(e / 3); });
  mesh.for_each_leaving(v, [&](std::uint32_t e) {
    const auto& t = mesh.triangle(e / 3);
    if (t[0] != u && t[1] != u && t[2] != u) visit(e / 3);
  });
}

}  // namespace

CarriedPoints::CarriedPoints(const TriMesh& input)
    : input_(input),
      first_(input.triangles.size(), none),
      next_(input.points_mm.size(), none),
      carrier_(input.points_mm.size(), none),
      squared_distance_(input.points_mm.size(), 0.0f) {
  for (std::uint32_t t = 0; t < input.triangles.size(); ++t)
    for (const std::uint32_t p : input.triangles[t]) {
      if (carrier_[p] != none) continue;
      carrier_[p] = t;
      next_[p] = first_[t];
      first_[t] = p;
    }
}

void CarriedPoints::gather(const CollapseMesh& mesh, std::uint32_t u, std::uint32_t v) {
  gathered_.clear();
  for_each_around(mesh, u, v, [&](std::uint32_t t) {
    for (std::uint32_t p = first_[t]; p != none; p = next_[p]) gathered_.push_back(p);
  });
}

bool CarriedPoints::assign(const std::vector<std::array<Vec3, 3>>& corners, double squared_limit) {
  assigned_.clear();
  farthest_ = 0;
  for (const std::uint32_t point : gathered_) {
    const Vec3 p = input_.points_mm[point];
    double best = std::numeric_limits<double>::infinity();
    std::uint32_t where = 0;
    for (std::uint32_t n = 0; n < corners.size() && best > 0; ++n) {
      const Vec3 d = p - closest_on_triangle(p, corners[n][0], corners[n][1], corners[n][2]);
      if (dot(d, d) >= best) continue;
      best = dot(d, d);
      where = n;
    }
    if (!(best <= squared_limit)) return false;
    farthest_ = std::max(farthest_, best);
    assigned_.emplace_back(where, static_cast<float>(best));
  }
  return true;
}

void CarriedPoints::commit(const CollapseMesh& mesh, std::uint32_t u, std::uint32_t v,
                           const std::vector<std::uint32_t>& triangles) {
  for_each_around(mesh, u, v, [&](std::uint32_t t) { first_[t] = none; });
  for (std::size_t n = 0; n < gathered_.size(); ++n) {
    const std::uint32_t point = gathered_[n], t = triangles[assigned_[n].first];
    carrier_[point] = t;
    squared_distance_[point] = assigned_[n].second;
    next_[point] = first_[t];
    first_[t] = point;
  }
}

}  // namespace trephine
