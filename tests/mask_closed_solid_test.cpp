// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "mask/surface_field.h"

namespace trephine {
namespace {

// A block with a cavity that holds a grain, and two pieces beside it.
grid::Field block() {
  grid::Lattice l;
  l.size = {40, 30, 20};
  grid::Field f(l, -3);
  const auto fill = [&](int from, int to, float value) {
    for (int k = from; k < to; ++k)
      for (int j = from; j < to; ++j)
        for (int i = from; i < to; ++i) f.at(i, j, k) = value;
  };
  fill(2, 16, 5);
  fill(6, 12, -2);
  fill(8, 10, 4);
  for (int i = 20; i < 24; ++i) f.at(i, 4, 4) = 7;   // 4 mm3
  for (int i = 20; i < 32; ++i) f.at(i, 20, 9) = 6;  // 12 mm3
  return f;
}

TEST(ClosedSolid, HasNoCavitiesAndNoCrumbs) {
  const grid::Field f = block();
  const auto closed = mask::closed_solid(f, 10);
  ASSERT_TRUE(closed);
  for (std::size_t v = 0; v < f.voxels.size(); ++v) {
    const int i = int(v % 40), j = int(v / 40 % 30), k = int(v / 1200);
    const bool in_block = std::min({i, j, k}) >= 2 && std::max({i, j, k}) < 16, long_piece = j == 20 && f.voxels[v] > 0;
    ASSERT_EQ(closed->voxels[v] > 0, in_block || long_piece) << i << " " << j << " " << k;
    // What was not filled or dropped is as it was.
    if ((closed->voxels[v] > 0) == (f.voxels[v] > 0)) {
      ASSERT_EQ(closed->voxels[v], f.voxels[v]);
    } else {
      ASSERT_EQ(closed->voxels[v], -f.voxels[v]);
    }
  }
  const auto all = mask::closed_solid(f, 0);
  ASSERT_TRUE(all);
  EXPECT_GT(all->at(21, 4, 4), 0);
}

// The largest piece stays whatever its size, and a solid that is closed already is nothing to copy.
TEST(ClosedSolid, IsNothingWhereAFieldIsOneAlready) {
  const auto closed = mask::closed_solid(block(), 1e6);
  ASSERT_TRUE(closed);
  EXPECT_GT(closed->at(3, 3, 3), 0);
  EXPECT_LT(closed->at(21, 20, 9), 0);
  EXPECT_FALSE(mask::closed_solid(*closed, 1e6));
}

}  // namespace
}  // namespace trephine
