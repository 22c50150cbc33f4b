// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "base/progress.h"
#include "surface/trimesh.h"

namespace trephine::boolean {

/// The rest of a surface after a solid was taken out of it: computed exactly and then rounded to double.
struct Difference {
  std::string fault;      ///< why there is none, or empty
  surface::TriMesh mesh;  ///< relative to the surface's origin; may be empty
  static constexpr std::uint32_t none = 0xffffffffu;
  /// For each triangle and point of the mesh the unchanged one of the surface that it is, or none. Those come first, in
  /// the surface's order; new ones follow in the order of their coordinates.
  std::vector<std::uint32_t> old_triangle, old_point;
};

/// CGAL's corefinement (Polygon mesh processing), in the bounded child. Both operands must be closed, 2-manifold,
/// oriented outwards and free of self-intersections. Near a degenerate position rounding may leave self-intersections
/// or degenerate triangles, which are not looked for. A child that dies or refuses is reported as a fault. Throws Error
/// 70 where it runs longer than time_limit_s or out of memory; Cancelled.
Difference corefine_difference(const surface::TriMesh& surface, const surface::TriMesh& solid, double time_limit_s,
                               const Progress& progress = {});

}  // namespace trephine::boolean
