// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The unit cells that a segment meets. Nothing here allocates or throws.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "base/vec3.h"

namespace trephine::contact {

/// What a walk does after a cell: end, go on to the next cell, or skip the rest of the cell's block.
enum class WalkStep { end, cell, block };

/// Calls visit(i, j, k, t0, t1) for each unit cell on the way from p to q, with t in [0, 1], going from face to face
/// [Amanatides1987]. Blocks have 2^block_bits cells a side. The last cell is always the one that holds q, however the
/// crossings were rounded. A cell that is visited has the same t0 and t1 whether blocks before it were skipped or not.
template <int block_bits, class Visit>
void walk_over_cells(Vec3 p, Vec3 q, const Visit& visit) {
  int cell[3], step[3], left[3];
  double next[3], begin[3], way[3], per_unit[3];
  const auto crossing = [&](int a, int from) { return (from + (step[a] > 0 ? 1 : 0) - begin[a]) * per_unit[a]; };
  const auto crossing_or_none = [&](int a) {
    return left[a] > 0 ? crossing(a, cell[a]) : std::numeric_limits<double>::infinity();
  };
  for (int a = 0; a < 3; ++a) {
    const double first = std::floor(p[a]), last = std::floor(q[a]);
    way[a] = q[a] - p[a];
    cell[a] = int(first);
    left[a] = std::abs(int(last) - cell[a]);
    step[a] = way[a] < 0 ? -1 : 1;
    begin[a] = p[a];
    per_unit[a] = way[a] != 0 ? 1 / way[a] : 0;
    next[a] = crossing_or_none(a);
  }
  double t = 0;
  const auto first_of = [](const double* v) { return v[0] <= v[1] ? (v[0] <= v[2] ? 0 : 2) : (v[1] <= v[2] ? 1 : 2); };
  while (true) {
    int a = first_of(next);
    const double until = left[a] > 0 ? std::clamp(next[a], t, 1.0) : 1;
    const WalkStep then = visit(cell[0], cell[1], cell[2], t, until);
    if (then == WalkStep::end || left[a] == 0) return;
    if (then == WalkStep::block) {
      // Where the way leaves the block along each axis, and along which it does so first.
      double out[3];
      int cells[3];
      constexpr int side = 1 << block_bits;
      for (int b = 0; b < 3; ++b) {
        const int within = cell[b] & (side - 1);
        cells[b] = step[b] > 0 ? side - 1 - within : within;
        out[b] =
            left[b] > cells[b] ? crossing(b, cell[b] + step[b] * cells[b]) : std::numeric_limits<double>::infinity();
      }
      a = first_of(out);
      if (out[a] == std::numeric_limits<double>::infinity()) return;
      // The other axes' crossings before that one, in the order in which single steps would take them.
      for (int b = 0; b < 3; ++b) {
        if (b == a) {
          cell[b] += step[b] * cells[b];
          left[b] -= cells[b];
          next[b] = out[a];
        } else {
          while (next[b] < out[a] || (next[b] == out[a] && b < a)) {
            cell[b] += step[b];
            --left[b];
            next[b] = crossing_or_none(b);
          }
        }
      }
      t = std::clamp(next[a], t, 1.0);
    } else {
      t = until;
    }
    cell[a] += step[a];
    --left[a];
    next[a] = crossing_or_none(a);
  }
}

}  // namespace trephine::contact
