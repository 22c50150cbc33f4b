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

namespace trephine::meshing {

/// Edge collapses in the order of their quadric error. Every collapse keeps the surface a closed 2-manifold, turns no
/// triangle over, makes no triangle thinner than necessary, and moves neither a carried point nor a few samples of the
/// triangles around it beyond the limit. Points lie on the raster of step_mm. The result is the same whatever the
/// thread count.
///
/// Far from the target the exact order matters little. There the mesh is thinned in rounds, each up to a cost below
/// which a share of the edges lies. Space is divided into cells, differently in each round, and every cell processes
/// its edges in order, in parallel with the other cells; an edge near a cell's wall waits for another round. The edges
/// that the rounds leave are processed in one sequence. While the quadrics say that the surface lies far within the
/// limit, and the count is far from the target, the input's points are not carried; they are taken up after that.
class EdgeCollapse {
 public:
  /// `input` must outlive this object. limit_mm 0: no limit.
  EdgeCollapse(const surface::TriMesh& input, double limit_mm, double step_mm);

  /// Collapses until at most `target` triangles are left, or no collapse is possible. Returns whether the limit kept an
  /// edge from collapsing. Afterwards the points are carried.
  bool run(std::size_t target, const Progress& progress);

  /// Undoes the last change of these triangles, or of the nearest ones around them that were changed, with everything
  /// that depends on it, and locks the points there. Returns how many collapses were undone; 0 only where these
  /// components have none.
  std::size_t undo(const std::vector<std::uint32_t>& triangles);

  const CollapseMesh& mesh() const { return mesh_; }
  CarriedPoints& carried() { return carried_; }
  /// To be called after the first run.
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
  /// A triangle around a moving point: half_edge leads from the point to b, and c is the third corner.
  struct Wing {
    std::uint32_t half_edge, b, c;
  };
  /// The working memory of one thread.
  struct Worker {
    std::vector<Candidate> sorted;  ///< the initial candidates, the first in order last
    std::vector<Candidate> heap;    ///< candidates that were added since
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
  bool near_input(Vec3 place, double limit2, const CarriedPoints::Hand& hand, std::size_t& last) const;
  bool samples_within(Worker& w) const;
  std::size_t undo_at(std::uint32_t triangle);
  std::vector<std::uint32_t> widened(const std::vector<std::uint32_t>& triangles) const;

  const surface::TriMesh& plain_input_;
  CollapseMesh mesh_;
  double limit2_, step_, area_ = 0, side_ = 0, sample_spacing_ = 0;
  CarriedPoints carried_;
  std::optional<NearInput> input_;       ///< once points are carried
  std::vector<StoredQuadric> quadrics_;  ///< about the points themselves
  std::vector<std::uint32_t> versions_;
  /// For each half-edge that is the lower of its two, the last computed cost of the edge; negative where its points
  /// have changed since; NaN: not known.
  std::vector<float> costs_;
  std::vector<char> flags_;     ///< per point
  std::vector<char> rejected_;  ///< per triangle a bit for each half-edge that did not collapse as things were
  std::vector<std::uint32_t> live_points_;  ///< during rounds; some may have died since
  std::size_t round_ = 0;
};

}  // namespace trephine::meshing
