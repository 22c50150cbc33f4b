// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "meshing/collapse_mesh.h"
#include "surface/incidence.h"
#include "surface/place_list.h"
#include "surface/trimesh.h"

namespace trephine::meshing {

/// The input's points, each carried by a live triangle near it. The squared distance to that triangle is an upper bound
/// of the point's distance to the surface, whatever was collapsed. Collapses may run at the same time under the rules
/// of CollapseMesh, each thread with its own Hand.
class CarriedPoints {
 public:
  /// Around a triangle.
  struct Ball {
    Vec3 middle;
    double radius_mm;
  };
  /// The working memory of one thread between gather, assign and commit.
  struct Hand {
    std::vector<std::uint32_t> points;
    surface::PlaceList places;
    std::vector<Ball> balls;                                ///< around the corners' triangles
    std::vector<std::pair<std::uint32_t, float>> assigned;  ///< per point: number of the corners, squared distance
    std::vector<std::pair<std::uint32_t, std::uint32_t>> sorted;  ///< the points with their place in `points`
  };

  /// The input must outlive this object. Nothing is carried until take_up.
  explicit CarriedPoints(const surface::TriMesh& input) : input_(input) {}

  /// Assigns each point to a triangle near it: it starts where the point was collapsed to and moves from triangle to
  /// neighbour as long as the distance falls. Parallel.
  void take_up(const CollapseMesh& mesh);
  bool carries() const { return !carrier_.empty(); }

  /// Collects the points that the triangles around u or v carry.
  void gather(const CollapseMesh& mesh, std::uint32_t u, std::uint32_t v, Hand& hand) const;
  /// Finds for each collected point the nearest of the triangles, which are given by their corners; returns false as
  /// soon as a point lies beyond the limit.
  bool assign(const std::vector<std::array<Vec3, 3>>& corners, double squared_limit, Hand& hand) const;
  /// Whether the places between those points (the midpoints of the input's edges and the centres of its triangles that
  /// belong to them alone) are within the limit of these triangles as well. Checks only where a point is beyond half
  /// the limit.
  bool between_within(const std::vector<std::array<Vec3, 3>>& corners, const surface::Incidence& incidence,
                      double squared_limit, Hand& hand) const;
  /// Makes triangles[n] carry what was assigned to corners[n]. The mesh must be unchanged since the points were
  /// gathered.
  void commit(const CollapseMesh& mesh, std::uint32_t u, std::uint32_t v, const std::vector<std::uint32_t>& triangles,
              const Hand& hand);

  std::uint32_t carrier(std::uint32_t point) const { return carrier_[point]; }
  /// Whether the triangle that carries the point, or the assignment, changed since take_up or forget_moves.
  bool moved(std::uint32_t point) const { return moved_[point]; }
  void forget_moves() { std::fill(moved_.begin(), moved_.end(), 0); }
  double squared_distance(std::uint32_t point) const { return squared_distance_[point]; }
  /// The first point that the triangle carries, and the next one after it; none where there are no more.
  std::uint32_t first_of(std::uint32_t triangle) const { return first_[triangle]; }
  std::uint32_t next_of(std::uint32_t point) const { return next_[point]; }

 private:
  const surface::TriMesh& input_;
  std::vector<std::uint32_t> first_, next_, carrier_;
  std::vector<float> squared_distance_;
  std::vector<char> moved_;
};

}  // namespace trephine::meshing
