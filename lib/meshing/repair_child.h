// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <string>

#include "base/progress.h"
#include "surface/trimesh.h"

namespace trephine::meshing {

/// What CGAL made of an oriented 2-manifold with borders.
struct Mended {
  std::string fault;        ///< why there is no mesh, or empty
  bool over_limit = false;  ///< the fault: the child reached its limit of time or memory
  surface::TriMesh mesh;    ///< relative to the input's origin; closed where there is no fault; not checked further
  std::int64_t holes = 0, degenerate = 0, self_intersections = 0, united = 0;
};

/// CGAL polygon mesh processing in the bounded child: removes degenerate triangles, stitches borders, fills holes,
/// collapses triangles lower than flattest_mm, cuts out and fills self-intersections of a piece, and unites overlapping
/// pieces. A child that dies, refuses, or runs longer than time_limit_s is reported as a fault; Cancelled.
Mended mend(const surface::TriMesh& mesh, double flattest_mm, double time_limit_s, const Progress& progress = {});

}  // namespace trephine::meshing
