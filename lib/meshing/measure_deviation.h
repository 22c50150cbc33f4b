// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <vector>

#include "base/progress.h"
#include "meshing/carried_points.h"
#include "meshing/collapse_mesh.h"
#include "meshing/triangle_tree.h"
#include "surface/incidence.h"
#include "surface/trimesh.h"

namespace trephine {

/// Sampled distances between two surfaces; rms and p99 are the larger of the two directions'.
struct DeviationFigures {
  double max_mm = 0, p99_mm = 0, rms_mm = 0;
};

/// Measures a collapsing mesh against its input, both ways. From the input: its points, and the middles of its
/// triangles. From the mesh: a raster over each triangle, its corners among it, not coarser than the input's mean edge.
/// A triangle that did not change since the last measurement is not measured again.
class DeviationMeter {
 public:
  /// The input must outlive this. limit_mm 0: no limit.
  DeviationMeter(const TriMesh& input, double limit_mm);

  /// Measures the mesh, given also as a plain one with the map of its triangles. Returns the collapsing mesh's
  /// triangles at samples beyond the limit, or that carry the points beside them, ascending. Distances are upper
  /// bounds, from what carries a point or from the triangles around the nearest point; they are exact where they exceed
  /// half the limit (without one: 1/32 of the mean edge).
  std::vector<std::uint32_t> measure(const CollapseMesh& mesh, const TriMesh& plain,
                                     const std::vector<std::uint32_t>& triangle_of, const CarriedPoints& carried,
                                     const Progress& progress);
  /// The raster over the triangle lies within the limit of the input. `near`: a point of the input to start the search
  /// at; becomes one near the triangle.
  bool within(const std::array<Vec3, 3>& corners, std::uint32_t& near) const;
  double mean_edge_mm() const { return edge_; }
  /// Of the last measurement.
  DeviationFigures figures() const;

 private:
  template <class Visit>
  void for_each_sample(const std::array<Vec3, 3>& corners, Visit&& visit) const;
  void from_input(const TriMesh& plain, const std::vector<std::uint32_t>& triangle_of, const CarriedPoints& carried,
                  std::vector<std::uint32_t>& beyond, const Progress& progress);
  void from_triangle(std::uint32_t t, const std::array<Vec3, 3>& corners, std::uint32_t near);
  double downhill(Vec3 place, std::uint32_t& near) const;
  double squared_distance(Vec3 place, std::uint32_t& near) const;

  struct Raster {
    std::uint32_t measured_change = 0;  ///< the collapse that had last changed the triangle, or none
    std::vector<float> distances;
    double area = 0;
    bool beyond = false;
  };
  const TriMesh& input_;
  double limit2_, edge_, spacing_, exact_beyond2_;
  TriangleTree tree_;
  Incidence incidence_;
  std::vector<float> forward_;
  std::vector<Raster> rasters_;           ///< per triangle that is live
  std::vector<std::uint32_t> raster_of_;  ///< the collapsing mesh's triangle -> its raster, or none
  std::vector<std::uint32_t> live_;       ///< rasters of the last measurement
};

}  // namespace trephine
