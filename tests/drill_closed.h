// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Whether a live surface is closed, and what it encloses.
#include <array>
#include <map>

#include "drill/live_surface.h"

namespace trephine::drilling {

// Edges of all bricks together, by the bits of their ends: each must be met as often one way as the other. And the
// volume that the triangles enclose, in mm3. A crowded edge has more than two triangles; a corner faces away where its
// normal and its triangle's are more than a right angle apart.
struct Closed {
  std::size_t open = 0, crowded = 0, triangles = 0, away = 0;
  double volume_mm3 = 0;
};
inline Closed look_at(const drill::LiveSurface& s) {
  using Point = std::array<float, 3>;
  struct Edge {
    int balance = 0, faces = 0;
  };
  std::map<std::pair<Point, Point>, Edge> edges;
  Closed out;
  for (std::size_t n = 0; n < s.layout().count(); ++n) {
    const drill::BrickMesh& b = s.brick(n);
    for (std::size_t t = 0; t + 2 < b.indices.size(); t += 3) {
      Point p[3];
      for (std::size_t c = 0; c < 3; ++c) {
        const float* at = b.vertices[b.indices[t + c]].position_mm;
        p[c] = {at[0], at[1], at[2]};
      }
      ++out.triangles;
      const Vec3 u{p[0][0], p[0][1], p[0][2]}, v{p[1][0], p[1][1], p[1][2]}, w{p[2][0], p[2][1], p[2][2]};
      out.volume_mm3 += dot(u, cross(v, w)) / 6;
      for (std::size_t c = 0; c < 3; ++c) {
        const Point &a = p[c], &z = p[(c + 1) % 3];
        Edge& edge = a < z ? edges[{a, z}] : edges[{z, a}];
        edge.balance += a < z ? 1 : -1;
        ++edge.faces;
      }
      const Vec3 out_of = cross(v - u, w - u);
      for (std::size_t c = 0; c < 3; ++c) {
        const float* normal = b.vertices[b.indices[t + c]].normal;
        out.away += dot(out_of, Vec3{normal[0], normal[1], normal[2]}) < 0;
      }
    }
  }
  for (const auto& [ends, edge] : edges) {
    out.open += edge.balance != 0;
    out.crowded += edge.faces > 2;
  }
  return out;
}

}  // namespace trephine::drilling
