// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <vector>

#include "base/progress.h"
#include "meshing/carried_points.h"
#include "surface/trimesh.h"

namespace trephine {

/// Sampled distances between two surfaces; rms and p99 are the larger of the two directions'.
struct DeviationSample {
  double max_mm = 0, p99_mm = 0, rms_mm = 0;
  std::vector<std::uint32_t> beyond;  ///< triangles of the result at samples beyond the limit, ascending, each once
};

/// From the input: its points and the middles of its triangles (`carried`, if given, spares most searches: its
/// distances are upper bounds). From the result: its points and a raster over each triangle, not coarser than the
/// input's mean edge. Both meshes must have the same origin; triangle_of maps the result's triangles to the carrier's,
/// may be empty without.
DeviationSample measure_deviation(const TriMesh& input, const TriMesh& result, double limit_mm,
                                  const CarriedPoints* carried, const std::vector<std::uint32_t>& triangle_of,
                                  const Progress& progress);

}  // namespace trephine
