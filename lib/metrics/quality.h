// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/report.h"
#include "surface/trimesh.h"

namespace trephine::metrics {

struct Quantiles {
  double min = 0, median = 0, p99 = 0, max = 0;  ///< nearest rank
};

/// The measures of a surface alone, except self-intersections (meshing/validity.h).
struct MeshMeasures {
  surface::Topology topology;
  double area_mm2 = 0;
  double volume_mm3 = 0;     ///< signed; of a closed, oriented mesh
  Quantiles edge_length_mm;  ///< each edge once
  /// Longest edge over inradius, divided by that of the equilateral triangle: 1 is best. Triangles without area are
  /// left out (topology.degenerate_triangles counts them).
  Quantiles aspect_ratio;
};

/// Throws 65 as check_mesh does. A mesh without triangles gives zeros.
MeshMeasures measure_mesh(const surface::TriMesh& mesh);

}  // namespace trephine::metrics
