// SPDX-License-Identifier: GPL-3.0-or-later
#include "touch/line_distance.h"

#include <algorithm>

#include "surface/point_triangle.h"

namespace trephine::touch {
namespace {

double squared(Vec3 v) { return dot(v, v); }

// Of two segments that are longer than a point: where on the first, and the place of the second.
LineToTriangle nearest_to_edge(Vec3 from, Vec3 way, Vec3 a, Vec3 edge) {
  const Vec3 r = from - a;
  const double ww = squared(way), ee = squared(edge), we = dot(way, edge), wr = dot(way, r), er = dot(edge, r);
  const double spread = ww * ee - we * we;
  double s = spread > 1e-12 * ww * ee ? std::clamp((we * er - wr * ee) / spread, 0.0, 1.0) : 0;
  double t = ee > 0 ? (we * s + er) / ee : 0;
  if (t < 0 || t > 1) {
    t = std::clamp(t, 0.0, 1.0);
    s = std::clamp((we * t - wr) / ww, 0.0, 1.0);
  }
  const Vec3 at = a + edge * t;
  return {squared(from + way * s - at), s, at};
}

}  // namespace

LineToTriangle nearest_to_line(Vec3 from, Vec3 to, Vec3 a, Vec3 b, Vec3 c) {
  const Vec3 way = to - from;
  if (!(squared(way) > 0)) {
    const Vec3 at = surface::closest_on_triangle(from, a, b, c);
    return {squared(from - at), 0, at};
  }
  // Nearest is a side, or the triangle's inside straight below an end of the line, or where the line goes through it.
  LineToTriangle best = nearest_to_edge(from, way, a, b - a);
  const auto take = [&](const LineToTriangle& other) {
    if (other.squared_mm2 < best.squared_mm2) best = other;
  };
  take(nearest_to_edge(from, way, b, c - b));
  take(nearest_to_edge(from, way, c, a - c));
  const Vec3 normal = cross(b - a, c - a);
  const double area = squared(normal);
  if (!(area > 0)) return best;
  const auto take_inside = [&](double along, Vec3 at, double squared_mm2) {
    const auto left_of = [&](Vec3 p, Vec3 q) { return dot(cross(q - p, at - p), normal) >= 0; };
    if (squared_mm2 < best.squared_mm2 && left_of(a, b) && left_of(b, c) && left_of(c, a))
      best = {squared_mm2, along, at};
  };
  const double begins = dot(normal, from - a), ends = dot(normal, to - a);
  if (begins * ends < 0) {
    const double along = begins / (begins - ends);
    take_inside(along, from + way * along, 0);
  } else {
    take_inside(0, from - normal * (begins / area), begins * begins / area);
    take_inside(1, to - normal * (ends / area), ends * ends / area);
  }
  return best;
}

}  // namespace trephine::touch
