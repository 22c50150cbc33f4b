// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <string>

#include "base/progress.h"
#include "surface/trimesh.h"

namespace trephine {

/// What CGAL made of an oriented 2-manifold with borders.
struct Mended {
  std::string fault;        ///< why there is nothing, or empty
  bool over_limit = false;  ///< the fault: the child reached its limit of time or memory
  TriMesh mesh;             ///< about the input's origin; closed where there is no fault; not checked further
  std::int64_t holes = 0, degenerate = 0, self_intersections = 0, united = 0;
};

/// CGAL polygon mesh processing, in the bounded child: degenerate triangles go, borders are stitched, holes filled,
/// triangles lower than flattest_mm collapsed, self-intersections of a piece cut out and filled, overlapping pieces
/// united. A child that dies or refuses, or runs longer than time_limit_s, is a fault; Cancelled.
Mended mend(const TriMesh& mesh, double flattest_mm, double time_limit_s, const Progress& progress = {});

}  // namespace trephine
