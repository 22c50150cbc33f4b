// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <optional>
#include <vector>

#include "base/progress.h"
#include "meshing/carried_points.h"
#include "meshing/collapse_mesh.h"
#include "meshing/near_input.h"
#include "meshing/quadric.h"

namespace trephine {

/// Edge collapses in the order of their quadric error. Every collapse keeps the surface a closed 2-manifold, turns no
/// triangle over, makes none thinner than it must, and takes no carried point, nor a few
/// samples of the triangles around it, further than the limit. Points lie on the
/// raster of step_mm. The same result whatever the thread count.
///
/// Far from the target the exact order matters little. There the mesh is thinned in rounds, each up to a cost that a
/// share of the edges stays below: space is cut into cells, other ones each time, and each cell works off its edges in
/// order, beside the other cells; an edge near a cell's wall waits for another round. What the rounds leave is done in
/// one go. While the quadrics say that the surface lies far within the limit, and the count is far from the target,
/// the input's points are not carried; they are taken up after that.
class EdgeCollapse {
 public:
  /// `input` must outlive this. limit_mm 0: no limit.
  EdgeCollapse(const TriMesh& input, double limit_mm, double step_mm);

  /// Collapses until at most target triangles are left, or no collapse is possible. Returns whether the limit was what
  /// kept an edge from collapsing. Afterwards the points are carried.
  bool run(std::size_t target, const Progress& progress);

  /// Undoes what last changed these triangles, or the nearest around them that were changed, with what depends on it,
  /// and locks the points there. Returns how many collapses went; 0 only where there is none on these components.
  std::size_t undo(const std::vector<std::uint32_t>& triangles);

  const CollapseMesh& mesh() const { return mesh_; }
  CarriedPoints& carried() { return carried_; }
  /// After the first run.
  const NearInput& input() const { return *input_; }

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
  /// A triangle around a moving point, which leaves the point by half_edge to b and has c as the third corner.
  struct Wing {
    std::uint32_t half_edge, b, c;
  };
  /// What one thread needs to work off edges.
  struct Worker {
    std::vector<Candidate> sorted;  ///< what there was to begin with, the first in order last
    std::vector<Candidate> heap;    ///< what came up since
    std::vector<Wing> wings_u, wings_v;
    std::vector<std::uint32_t> staying;  ///< the triangles that stay, with their corners after the collapse
    std::vector<std::array<Vec3, 3>> corners;
    CarriedPoints::Hand hand;
    CollapseMesh::Log log;
    bool limited = false;
  };
  struct Cells;
  enum Flag : char { locked = 1, core = 2 };

  void rounds(std::size_t target, std::size_t floor, bool& limited, const Progress& progress);
  void finish(std::size_t target, bool& limited, const Progress& progress);
  void take_up();
  void undo_beyond();
  float cost_below(double share) const;
  Cells cut(std::size_t round);
  void gather(const std::uint32_t* from, const std::uint32_t* to, float cost_limit, std::vector<Candidate>& edges);
  void work_off(std::size_t count, float cost_limit, Worker& w, const std::function<void()>& tick);
  Vec3 place(std::uint32_t u, std::uint32_t v, double& cost, double& weight) const;
  bool candidate(std::uint32_t half_edge, Candidate& c) const;
  bool bounded_candidate(std::uint32_t half_edge, Candidate& c);
  Outcome attempt(std::uint32_t half_edge, Worker& w);
  bool keeps_manifold(std::uint32_t u, std::uint32_t v, Worker& w) const;
  bool keeps_shape(std::uint32_t u, std::uint32_t v, Vec3 at, Worker& w) const;
  bool near_input(Vec3 place, double limit2, const CarriedPoints::Hand& hand) const;
  bool samples_within(Worker& w) const;
  std::size_t undo_at(std::uint32_t triangle);
  std::vector<std::uint32_t> widened(const std::vector<std::uint32_t>& triangles) const;

  const TriMesh& plain_input_;
  CollapseMesh mesh_;
  double limit2_, step_, area_ = 0, sample_spacing_ = 0;
  CarriedPoints carried_;
  std::optional<NearInput> input_;       ///< once points are carried
  std::vector<StoredQuadric> quadrics_;  ///< about the points themselves
  std::vector<std::uint32_t> versions_;
  /// Per half-edge that is the lower of its two: the edge's cost as last computed; negative where its points have
  /// changed since; no number: not known.
  std::vector<float> costs_;
  std::vector<char> flags_;     ///< per point
  std::vector<char> rejected_;  ///< per triangle a bit for each half-edge that did not collapse as things were
  std::vector<std::uint32_t> live_points_;  ///< during rounds; some may have died since
  std::size_t round_ = 0;
};

}  // namespace trephine
