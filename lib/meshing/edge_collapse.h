// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>
#include <vector>

#include "base/progress.h"
#include "meshing/carried_points.h"
#include "meshing/collapse_mesh.h"
#include "meshing/quadric.h"

namespace trephine {

/// Edge collapses in the order of their quadric error. Every collapse keeps the surface a closed 2-manifold, turns no
/// triangle over, makes none thinner than it must, and takes no carried point further than the limit. Points lie on the
/// raster of step_mm. Sequential and deterministic.
class EdgeCollapse {
 public:
  /// `input` must outlive this. limit_mm 0: no limit, and nothing is carried.
  EdgeCollapse(const TriMesh& input, double limit_mm, double step_mm);

  /// Collapses until at most target triangles are left, or no collapse is possible. Returns whether the limit was what
  /// kept an edge from collapsing.
  bool run(std::size_t target, const Progress& progress);

  /// Undoes what last changed these triangles (and what depends on it) and locks the points there. Returns how many
  /// collapses went.
  std::size_t undo(const std::vector<std::uint32_t>& triangles);

  const CollapseMesh& mesh() const { return mesh_; }
  const CarriedPoints* carried() const { return carried_.get(); }

 private:
  struct Candidate {
    float cost;
    std::uint32_t half_edge;
    std::uint32_t version;
  };
  enum class Outcome { done, shape, limit };
  static bool later(const Candidate& a, const Candidate& b);
  Vec3 place(std::uint32_t u, std::uint32_t v, double& cost) const;
  bool candidate(std::uint32_t half_edge, Candidate& c) const;
  Outcome attempt(std::uint32_t half_edge);
  bool keeps_shape(std::uint32_t u, std::uint32_t v, Vec3 at);

  CollapseMesh mesh_;
  double squared_limit_, step_;
  std::unique_ptr<CarriedPoints> carried_;
  std::vector<Quadric> quadrics_;
  std::vector<std::uint32_t> versions_;
  std::vector<char> locked_;
  std::vector<Candidate> heap_;
  // What keeps_shape saw: the triangles that stay, with their corners after the collapse.
  std::vector<std::uint32_t> staying_;
  std::vector<std::array<Vec3, 3>> corners_;
};

}  // namespace trephine
