// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/cube_table.h"

#include <cmath>
#include <limits>

namespace trephine::meshing::cubes {
namespace {

using Point = std::array<double, 3>;

int edge_between(int a, int b) {
  const int axis = (a ^ b) == 1 ? 0 : (a ^ b) == 2 ? 1 : 2, low = a & b;
  for (int e = 4 * axis; e < 4 * axis + 4; ++e)
    if (edge_corner(e) == low) return e;
  return -1;
}

bool on_common_face(int e, int f) {
  for (const auto& corners : face_corners) {
    int found = 0;
    for (int i = 0; i < 4; ++i) {
      const int g = edge_between(corners[i], corners[(i + 1) % 4]);
      found += (g == e) + (g == f);
    }
    if (found == 2) return true;
  }
  return false;
}

Point middle(int edge) {
  const int c = edge_corner(edge);
  Point p{double(c & 1), double(c >> 1 & 1), double(c >> 2 & 1)};
  p[edge_axis(edge)] = 0.5;
  return p;
}

double triangle_cost(int a, int b, int c) {
  const Point p = middle(a), q = middle(b), r = middle(c);
  double u[3], v[3];
  for (int i = 0; i < 3; ++i) {
    u[i] = q[i] - p[i];
    v[i] = r[i] - p[i];
  }
  const double x = u[1] * v[2] - u[2] * v[1], y = u[2] * v[0] - u[0] * v[2], z = u[0] * v[1] - u[1] * v[0];
  return std::sqrt(x * x + y * y + z * z);
}

/// The triangulation of the loop with the smallest area among those without a diagonal in a face (dynamic programming).
void triangulate(const std::vector<int>& loop, std::vector<std::uint8_t>& out) {
  const int n = static_cast<int>(loop.size());
  std::vector<double> cost(n * n, 0);
  std::vector<int> split(n * n, -1);
  for (int span = 2; span < n; ++span)
    for (int i = 0; i + span < n; ++i) {
      const int j = i + span;
      double& best = cost[i * n + j] = std::numeric_limits<double>::infinity();
      const bool diagonal = span != n - 1;
      if (diagonal && on_common_face(loop[i], loop[j])) continue;
      for (int k = i + 1; k < j; ++k) {
        const double c = cost[i * n + k] + cost[k * n + j] + triangle_cost(loop[i], loop[k], loop[j]);
        if (c < best - 1e-12) {
          best = c;
          split[i * n + j] = k;
        }
      }
    }
  std::vector<std::array<int, 2>> todo{{0, n - 1}};
  while (!todo.empty()) {
    const auto [i, j] = todo.back();
    todo.pop_back();
    if (j - i < 2) continue;
    const int k = split[i * n + j];
    for (const int v : {i, k, j}) out.push_back(static_cast<std::uint8_t>(loop[v]));
    todo.push_back({i, k});
    todo.push_back({k, j});
  }
}

/// For each crossed edge the next one around the surface, walking so that the inside lies to the left seen from outside
/// the material.
std::array<int, edge_count> links(int signs) {
  std::array<int, edge_count> next;
  next.fill(-1);
  for (int f = 0; f < 6; ++f) {
    const auto& c = face_corners[f];
    const auto inside = [&](int i) { return (signs >> c[(i + 4) % 4] & 1) != 0; };
    const auto edge = [&](int i) { return edge_between(c[(i + 4) % 4], c[(i + 5) % 4]); };
    for (int i = 0; i < 4; ++i) {
      if (!inside(i) || inside(i + 1)) continue;  // edge i leaves the inside
      // A crossing is joined to the next one around the face, which enters the material again. Where a face has four
      // crossings, the segments therefore cut off the outside corners and join the inside ones.
      int partner = i + 1;
      while (inside(partner) || !inside(partner + 1)) ++partner;
      next[edge(partner)] = edge(i);
    }
  }
  return next;
}

Table build() {
  Table t;
  for (int signs = 0; signs < 256; ++signs) {
    t.first[signs] = static_cast<std::uint16_t>(t.edges.size());
    auto next = links(signs);
    for (int e = 0; e < edge_count; ++e) {
      std::vector<int> loop;
      for (int at = e; next[at] >= 0;) {
        loop.push_back(at);
        const int to = next[at];
        next[at] = -1;
        at = to;
      }
      if (!loop.empty()) triangulate(loop, t.edges);
    }
  }
  t.first[256] = static_cast<std::uint16_t>(t.edges.size());
  return t;
}

}  // namespace

const Table& table() {
  static const Table t = build();
  return t;
}

}  // namespace trephine::meshing::cubes
