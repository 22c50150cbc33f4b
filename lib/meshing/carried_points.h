// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "meshing/collapse_mesh.h"
#include "meshing/place_list.h"
#include "surface/incidence.h"
#include "surface/trimesh.h"

namespace trephine {

/// The input's points, each carried by a live triangle that lies near it: its squared distance to that triangle bounds
/// its distance to the surface from above, whatever was collapsed. Collapses may run at the same time as CollapseMesh
/// says, each thread with a Hand of its own.
class CarriedPoints {
 public:
  /// What one thread holds between gather, assign and commit.
  struct Hand {
    std::vector<std::uint32_t> points;
    PlaceList places;
    std::vector<std::pair<std::uint32_t, float>> assigned;  ///< per point: number of the corners, squared distance
    std::vector<std::pair<std::uint32_t, std::uint32_t>> sorted;  ///< the points with their place in `points`
  };

  /// The input must outlive this. Nothing is carried until take_up.
  explicit CarriedPoints(const TriMesh& input) : input_(input) {}

  /// Lets each point be carried by a triangle near it: from where it was collapsed to, from triangle to neighbour as
  /// long as that leads nearer. Parallel.
  void take_up(const CollapseMesh& mesh);
  bool carries() const { return !carrier_.empty(); }

  /// Takes up the points that the triangles around u or v carry.
  void gather(const CollapseMesh& mesh, std::uint32_t u, std::uint32_t v, Hand& hand) const;
  /// Finds for each of them the nearest of the triangles given by their corners; false as soon as one lies beyond the
  /// limit.
  bool assign(const std::vector<std::array<Vec3, 3>>& corners, double squared_limit, Hand& hand) const;
  /// Whether what lies between those points, the middles of the input's edges and triangles that are theirs alone, is
  /// within the limit of these triangles as well. Looks only where a point has come half that way.
  bool between_within(const std::vector<std::array<Vec3, 3>>& corners, const Incidence& incidence, double squared_limit,
                      Hand& hand) const;
  /// Lets triangles[n] carry what was assigned to corners[n]. The mesh must still be as it was when they were gathered.
  void commit(const CollapseMesh& mesh, std::uint32_t u, std::uint32_t v, const std::vector<std::uint32_t>& triangles,
              const Hand& hand);

  std::uint32_t carrier(std::uint32_t point) const { return carrier_[point]; }
  /// What carries the point, or that triangle itself, changed since take_up or forget_moves.
  bool moved(std::uint32_t point) const { return moved_[point]; }
  void forget_moves() { std::fill(moved_.begin(), moved_.end(), 0); }
  double squared_distance(std::uint32_t point) const { return squared_distance_[point]; }
  /// A point that the triangle carries, and another one after it; none: no more.
  std::uint32_t first_of(std::uint32_t triangle) const { return first_[triangle]; }
  std::uint32_t next_of(std::uint32_t point) const { return next_[point]; }

 private:
  const TriMesh& input_;
  std::vector<std::uint32_t> first_, next_, carrier_;
  std::vector<float> squared_distance_;
  std::vector<char> moved_;
};

}  // namespace trephine
