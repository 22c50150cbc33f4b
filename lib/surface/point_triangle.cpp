// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/point_triangle.h"

#include "surface/triangle_frame.h"

namespace trephine::surface {

ClosestPoint nearest_on_triangle(Vec3 p, Vec3 a, Vec3 b, Vec3 c) { return TriangleFrame(a, b, c).nearest(p); }

}  // namespace trephine::surface
