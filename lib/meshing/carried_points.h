// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "meshing/collapse_mesh.h"
#include "surface/trimesh.h"

namespace trephine {

/// The input's points, each carried by a live triangle that lies near it: its squared distance to that triangle bounds
/// its distance to the surface from above, whatever was collapsed.
class CarriedPoints {
 public:
  explicit CarriedPoints(const TriMesh& input);

  /// Takes up the points that the triangles around u or v carry.
  void gather(const CollapseMesh& mesh, std::uint32_t u, std::uint32_t v);
  /// Finds for each of them the nearest of the triangles given by their corners; false as soon as one lies beyond the
  /// limit.
  bool assign(const std::vector<std::array<Vec3, 3>>& corners, double squared_limit);
  /// The largest squared distance that assign found.
  double farthest() const { return farthest_; }
  /// Lets triangles[n] carry what was assigned to corners[n]. The mesh must still be as it was when they were gathered.
  void commit(const CollapseMesh& mesh, std::uint32_t u, std::uint32_t v, const std::vector<std::uint32_t>& triangles);

  std::uint32_t carrier(std::uint32_t point) const { return carrier_[point]; }
  double squared_distance(std::uint32_t point) const { return squared_distance_[point]; }

 private:
  const TriMesh& input_;
  std::vector<std::uint32_t> first_, next_, carrier_;
  std::vector<float> squared_distance_;
  double farthest_ = 0;
  std::vector<std::uint32_t> gathered_;
  std::vector<std::pair<std::uint32_t, float>> assigned_;
};

}  // namespace trephine
