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
  const std::vector<bool> turned = mask::turned_by_contour(f, 10);
  ASSERT_EQ(turned.size(), f.count());
  for (std::size_t v = 0; v < f.voxels.size(); ++v) {
    const int i = int(v % 40), j = int(v / 40 % 30), k = int(v / 1200);
    const bool in_block = std::min({i, j, k}) >= 2 && std::max({i, j, k}) < 16, long_piece = j == 20 && f.voxels[v] > 0;
    ASSERT_EQ((f.voxels[v] > 0) != turned[v], in_block || long_piece) << i << " " << j << " " << k;
  }
  EXPECT_FALSE(mask::turned_by_contour(f, 0)[f.index(21, 4, 4)]);
}

// The largest piece stays whatever its size, and in a solid that is closed already nothing is turned.
TEST(ClosedSolid, IsNothingWhereAFieldIsOneAlready) {
  grid::Field f = block();
  const std::vector<bool> turned = mask::turned_by_contour(f, 1e6);
  ASSERT_EQ(turned.size(), f.count());
  EXPECT_FALSE(turned[f.index(3, 3, 3)]);
  EXPECT_TRUE(turned[f.index(21, 20, 9)]);
  for (std::size_t v = 0; v < f.count(); ++v)
    if (turned[v]) f.voxels[v] = -f.voxels[v];
  EXPECT_TRUE(mask::turned_by_contour(f, 1e6).empty());
}

}  // namespace
}  // namespace trephine
