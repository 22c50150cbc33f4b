// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>

#include "base/vec3.h"

namespace trephine::meshing {

// Exact predicates on double coordinates (CGAL's filtered kernel inside).

/// Whether the three points lie on a line or coincide.
bool on_a_line(Vec3 a, Vec3 b, Vec3 c);

/// Whether two triangles, neither of which is degenerate, intersect. Without a shared index they intersect where they
/// touch; with one or two where they touch or overlap beyond the shared point or edge; with three always.
bool triangles_intersect(const std::array<std::uint32_t, 3>& ia, const std::array<Vec3, 3>& a,
                         const std::array<std::uint32_t, 3>& ib, const std::array<Vec3, 3>& b);

}  // namespace trephine::meshing
