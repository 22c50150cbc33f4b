// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <random>
#include <tuple>
#include <vector>

#include "contact/cell_walk.h"
#include "contact_walls.h"

using namespace trephine;
using walls::uniform;

namespace {

using Cell = std::tuple<int, int, int, double, double>;

// A cell's block is left out where its number says so: as blocks of one shape are, here and there.
bool left_out(int i, int j, int k) { return ((i >> 2) * 7 + (j >> 2) * 5 + (k >> 2) * 3) % 4 != 0; }

std::vector<Cell> cells_of(Vec3 p, Vec3 q, bool skip) {
  std::vector<Cell> out;
  contact::walk_over_cells<2>(p, q, [&](int i, int j, int k, double t0, double t1) {
    out.emplace_back(i, j, k, t0, t1);
    return skip && left_out(i, j, k) ? contact::WalkStep::block : contact::WalkStep::cell;
  });
  return out;
}

}  // namespace

// What is visited when blocks are left out is what is visited otherwise, bit for bit, less those blocks' other cells.
TEST(ContactWalk, LeavingOutBlocksChangesNothingElse) {
  std::mt19937_64 rng(31);
  std::size_t all_cells = 0, visited = 0;
  for (int n = 0; n < 200000; ++n) {
    Vec3 p, q;
    for (int a = 0; a < 3; ++a) {
      p[a] = uniform(rng, -20, 20);
      q[a] = uniform(rng, -20, 20);
      // Corners, edges, and ways along an axis: where crossings coincide.
      if (rng() % 3 == 0) p[a] = std::floor(p[a]);
      if (rng() % 3 == 0) q[a] = std::floor(q[a]);
      if (rng() % 6 == 0) q[a] = p[a];
      if (rng() % 6 == 0) q[a] = p[a] + (rng() % 2 ? 8 : -8);
    }
    const std::vector<Cell> all = cells_of(p, q, false);
    std::vector<Cell> expected;
    bool out = false;
    int bi = 0, bj = 0, bk = 0;
    for (const Cell& c : all) {
      const auto [i, j, k, t0, t1] = c;
      if (out && i >> 2 == bi && j >> 2 == bj && k >> 2 == bk) continue;
      expected.push_back(c);
      out = left_out(i, j, k);
      bi = i >> 2, bj = j >> 2, bk = k >> 2;
    }
    ASSERT_EQ(cells_of(p, q, true), expected) << n;
    const auto [i, j, k, t0, t1] = all.back();
    ASSERT_EQ((Vec3{double(i), double(j), double(k)}), (Vec3{std::floor(q.x), std::floor(q.y), std::floor(q.z)}));
    all_cells += all.size();
    visited += expected.size();
  }
  EXPECT_LT(2 * visited, all_cells);
}
