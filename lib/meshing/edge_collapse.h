// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "base/progress.h"
#include "meshing/carried_points.h"
#include "meshing/collapse_mesh.h"
#include "meshing/measure_deviation.h"
#include "meshing/quadric.h"

namespace trephine {

/// Edge collapses in the order of their quadric error. Every collapse keeps the surface a closed 2-manifold, turns no
/// triangle over, makes none thinner than it must, and takes no carried point, nor a few samples of the triangles
/// around it, further than the limit. Points lie on the raster of step_mm. The same result whatever the thread count.
///
/// A large mesh is first thinned in sweeps, each of which collapses cheap edges in the order of memory, with no
/// triangle touched twice (so that no chain of collapses hangs together, if one has to be undone): far from the target
/// the exact order matters little, and the heap's order costs cache misses at every step.
class EdgeCollapse {
 public:
  /// `input` and `meter` must outlive this. limit_mm 0: no limit.
  EdgeCollapse(const TriMesh& input, const DeviationMeter& meter, double limit_mm, double step_mm);

  /// Collapses until at most target triangles are left, or no collapse is possible. Returns whether the limit was what
  /// kept an edge from collapsing.
  bool run(std::size_t target, const Progress& progress);

  /// Undoes what last changed these triangles, or the nearest around them that were changed, with what depends on it,
  /// and locks the points there. Returns how many collapses went; 0 only where there is none on these components.
  std::size_t undo(const std::vector<std::uint32_t>& triangles);

  const CollapseMesh& mesh() const { return mesh_; }
  const CarriedPoints& carried() const { return carried_; }

 private:
  struct Candidate {
    float cost;
    std::uint32_t half_edge;
    std::uint32_t version;
  };
  struct Later {
    bool operator()(const Candidate& a, const Candidate& b) const {
      return a.cost > b.cost || (a.cost == b.cost && a.half_edge > b.half_edge);
    }
  };
  enum class Outcome { done, shape, limit };
  bool sweep(std::size_t floor, bool& limited);
  bool samples_within();
  std::size_t undo_at(std::uint32_t triangle);
  std::vector<std::uint32_t> widened(const std::vector<std::uint32_t>& triangles) const;
  Vec3 place(std::uint32_t u, std::uint32_t v, double& cost) const;
  bool candidate(std::uint32_t half_edge, Candidate& c) const;
  Outcome attempt(std::uint32_t half_edge);
  bool keeps_shape(std::uint32_t u, std::uint32_t v, Vec3 at);

  const DeviationMeter& meter_;
  CollapseMesh mesh_;
  double squared_limit_, step_;
  CarriedPoints carried_;
  std::vector<Quadric> quadrics_;
  std::vector<std::uint32_t> versions_;
  std::vector<char> locked_;
  std::vector<std::uint32_t> near_;  ///< per live triangle a point of the input near it
  std::vector<Candidate> heap_;
  // What keeps_shape saw: the triangles that stay, with their corners after the collapse.
  std::vector<std::uint32_t> staying_;
  std::vector<std::array<Vec3, 3>> corners_;
};

}  // namespace trephine
