// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/progress.h"
#include "meshing/carried_points.h"
#include "meshing/collapse_mesh.h"
#include "meshing/near_input.h"
#include "meshing/prove_within.h"
#include "surface/triangle_tree.h"
#include "surface/trimesh.h"

namespace trephine::meshing {

/// Sampled distances between two surfaces; rms and p99 are the larger of the two directions'.
struct DeviationFigures {
  double max_mm = 0, p99_mm = 0, rms_mm = 0;
};

/// Measures a collapsing mesh against its input, both ways. From the input: its points, and the middles of its edges
/// and triangles. From the mesh: a raster over each triangle, its corners among it, not coarser than the input's mean
/// edge (without a limit twice that). What did not change since the last measurement is not measured again. Where there
/// is a limit, also proves that no point between samples lies beyond the bound.
class DeviationMeter {
 public:
  /// The input must outlive this. limit_mm, of samples, 0: no limit. bound_mm, of every point, is the larger one.
  DeviationMeter(const NearInput& input, double limit_mm, double bound_mm);

  /// Measures the mesh, given also as a plain one with the map of its triangles. Returns the collapsing mesh's
  /// triangles at samples beyond the limit, or that carry the points beside them, ascending; where there is none, those
  /// that are not proven to lie within the bound, or at which the input is not. Distances are upper
  /// bounds, from what carries a point or from the triangles around the nearest point; they are exact where they exceed
  /// 0.85 of the limit (without one: a quarter of the mean edge).
  std::vector<std::uint32_t> measure(const surface::TriMesh& plain, const std::vector<std::uint32_t>& triangle_of,
                                     CarriedPoints& carried, const Progress& progress);
  /// Of the last measurement.
  DeviationFigures figures() const;

 private:
  struct Raster {
    std::array<Vec3, 3> corners;  ///< as they were measured
    std::vector<float> distances;
    bool beyond = false, proven = true;
  };
  /// `tree` is over `plain`, plain_of leads from the collapsing mesh's triangles to its own.
  void from_input(const surface::TriMesh& plain, const surface::TriangleTree& tree,
                  const std::vector<std::uint32_t>& plain_of, const CarriedPoints& carried,
                  std::vector<std::uint32_t>& beyond, const Progress& progress);
  /// What one thread needs.
  struct Room {
    std::vector<std::uint32_t> points;  ///< some of the input near the triangle
    surface::PlaceList places;
    std::vector<NearbyPlace> samples;
    bool lacks_tree = false;
    std::vector<std::array<NearbyPlace, 3>> stack;
  };
  bool from_triangle(Raster& raster, Room& room) const;
  bool cells_proven(const std::vector<NearbyPlace>& samples, int n, Room& room) const;
  void input_unproven(const surface::TriMesh& plain, const surface::TriangleTree& tree,
                      const std::vector<std::uint32_t>& plain_of, const CarriedPoints& carried,
                      std::vector<std::uint32_t>& beyond, const Progress& progress);
  void look(NearbyPlace& place, bool& lacks_tree) const;

  const NearInput& near_;
  const surface::TriMesh& input_;
  double limit2_, bound_, edge_, spacing_, raster_beyond2_, exact_beyond2_;
  std::optional<surface::TriangleTree> tree_;   ///< over the input, once a place is too far for the search from a point
  std::vector<std::vector<float>> forward_;     ///< from the input, by pieces of it
  std::vector<char> input_beyond_;              ///< by triangles of the input: a sample of it is beyond the limit
  std::vector<Raster> rasters_;                 ///< per triangle that is live
  std::vector<std::uint32_t> raster_of_;        ///< the collapsing mesh's triangle -> its raster, or none
  std::vector<std::uint32_t> live_;             ///< rasters of the last measurement
  std::vector<std::array<Vec3, 3>> gone_;       ///< triangles that are no longer there, since input_unproven
  std::vector<char> input_proven_;              ///< by triangles of the input
  std::vector<surface::FloatBox> block_boxes_;  ///< of some of these together
};

}  // namespace trephine::meshing
