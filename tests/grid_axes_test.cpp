// SPDX-License-Identifier: GPL-3.0-or-later
#include "grid/axes.h"

#include <gtest/gtest.h>

#include "base/error.h"

namespace trephine {
namespace {

grid::Grid<std::int16_t> sample() {
  grid::Grid<std::int16_t> g;
  g.size = {3, 4, 5};
  g.spacing_mm = {1, 2, 3};
  g.origin_mm = {-10, 20, 30};
  g.voxels.resize(g.count());
  for (std::size_t v = 0; v < g.count(); ++v) g.voxels[v] = std::int16_t(v);
  return g;
}

Vec3 place_of(const grid::Grid<std::int16_t>& g, std::int16_t value) {
  for (int k = 0; k < g.size[2]; ++k)
    for (int j = 0; j < g.size[1]; ++j)
      for (int i = 0; i < g.size[0]; ++i)
        if (g.at(i, j, k) == value) return g.to_world_mm({double(i), double(j), double(k)});
  return {};
}

TEST(Axes, EachVoxelLiesWhereTheLettersSay) {
  const auto before = sample();
  const Vec3 middle = before.to_world_mm({1, 1.5, 2});
  for (const char* axes : {"LPS", "LPI", "RAS", "LAS", "PSL", "IRA"}) {
    const auto after = std::get<grid::Grid<std::int16_t>>(grid::with_axes(before, axes));
    EXPECT_NEAR(determinant(after.direction), 1, 1e-12) << axes;
    for (std::size_t v = 0; v < before.count(); ++v) {
      const Vec3 index{double(v % 3), double(v / 3 % 4), double(v / 12)};
      Vec3 expected = middle;
      for (int a = 0; a < 3; ++a) {
        const double mm = (index[a] - 0.5 * (before.size[std::size_t(a)] - 1)) * before.spacing_mm[a];
        const char letter = axes[a];
        const int to = letter == 'L' || letter == 'R' ? 0 : letter == 'P' || letter == 'A' ? 1 : 2;
        expected[to] += letter == 'L' || letter == 'P' || letter == 'S' ? mm : -mm;
      }
      EXPECT_LT(norm(place_of(after, std::int16_t(v)) - expected), 1e-9) << axes << " " << v;
    }
  }
}

TEST(Axes, OtherLettersAreRefused) {
  for (const char* axes : {"", "LP", "LPSS", "LLS", "LRS", "lps", "XYZ"})
    EXPECT_THROW(grid::with_axes(sample(), axes), Error) << axes;
}

}  // namespace
}  // namespace trephine
