// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/vec3.h"

namespace trephine::touch {

/// The place of a line from one point to another (which may be the same) that is nearest to a triangle, and the
/// triangle's place that is nearest to it [Ericson2005, 5.1.9 and 5.1.10].
struct LineToTriangle {
  double squared_mm2 = 0;
  double along = 0;  ///< on the line, 0 to 1
  Vec3 point_mm;     ///< of the triangle
};
LineToTriangle nearest_to_line(Vec3 from_mm, Vec3 to_mm, Vec3 a, Vec3 b, Vec3 c);

}  // namespace trephine::touch
