// SPDX-License-Identifier: GPL-3.0-or-later
#include "drill/cell_triangles.h"

namespace trephine::drill::detail {
namespace {

// The edge between two corners that differ in one axis.
int edge_between(int a, int b) {
  const int axis = (a ^ b) == 1 ? 0 : (a ^ b) == 2 ? 1 : 2, low = a & b;
  const int m = axis == 0 ? low >> 1 : axis == 1 ? (low & 1) | (low & 4) >> 1 : low & 3;
  return 4 * axis + m;
}

// The corners of each face, counter-clockwise seen from outside the cell.
constexpr int faces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};

bool in_one_face(int edge, int other) {
  for (const auto& face : faces) {
    bool one = false, two = false;
    for (int n = 0; n < 4; ++n) {
      const int e = edge_between(face[n], face[(n + 1) & 3]);
      one = one || e == edge;
      two = two || e == other;
    }
    if (one && two) return true;
  }
  return false;
}

// Where the loop's fan begins so that none of its diagonals lies in a face of the cell: the neighbour's could lie there
// too, and that edge would have four triangles. Of all loops of a cell there is one.
int fan_begin(const int* loop, int length) {
  for (int first = 0; first < length; ++first) {
    bool good = true;
    for (int n = 2; n + 1 < length; ++n) good = good && !in_one_face(loop[first], loop[(first + n) % length]);
    if (good) return first;
  }
  return 0;
}

// Each face's outline passes from empty to solid and back. What lies between is cut off by a segment; the segments of
// all faces join at the edges to closed loops, and each loop is a fan of triangles.
CellTriangles triangles_of(int solid) {
  int next[12];
  for (int& n : next) n = -1;
  for (const auto& face : faces)
    for (int n = 0; n < 4; ++n) {
      const auto is_solid = [&](int at) { return (solid >> face[at & 3] & 1) != 0; };
      if (is_solid(n) || !is_solid(n + 1)) continue;
      int last = n + 1;
      while (is_solid(last + 1)) ++last;
      next[edge_between(face[last & 3], face[(last + 1) & 3])] = edge_between(face[n], face[(n + 1) & 3]);
    }
  CellTriangles out;
  for (int first = 0; first < 12; ++first) {
    if (next[first] < 0) continue;
    int loop[12], length = 0;
    for (int e = first; next[e] >= 0;) {
      loop[length++] = e;
      const int then = next[e];
      next[e] = -1;
      e = then;
    }
    const int begin = fan_begin(loop, length);
    for (int n = 1; n + 1 < length; ++n) {
      const std::size_t at = std::size_t(3 * out.count++);
      out.edge[at] = std::uint8_t(loop[begin]);
      out.edge[at + 1] = std::uint8_t(loop[(begin + n + 1) % length]);
      out.edge[at + 2] = std::uint8_t(loop[(begin + n) % length]);
    }
  }
  return out;
}

std::array<CellTriangles, 256> make_all() {
  std::array<CellTriangles, 256> all;
  for (int solid = 0; solid < 256; ++solid) all[std::size_t(solid)] = triangles_of(solid);
  return all;
}

}  // namespace

const std::array<CellTriangles, 256>& cell_triangles() {
  static const std::array<CellTriangles, 256> all = make_all();
  return all;
}

}  // namespace trephine::drill::detail
