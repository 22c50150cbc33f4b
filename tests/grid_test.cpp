// SPDX-License-Identifier: GPL-3.0-or-later
#include "grid/grid.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"

namespace trephine {
namespace {

grid::Lattice oblique() {
  grid::Lattice l;
  l.size = {7, 6, 5};
  l.spacing_mm = {0.47, 0.48, 1.25};
  l.origin_mm = {-12.3, 45.6, 789.1};
  const double a = 0.3, b = -0.2;
  l.direction.column[0] = {std::cos(a), std::sin(a), 0};
  l.direction.column[1] = {-std::sin(a) * std::cos(b), std::cos(a) * std::cos(b), std::sin(b)};
  l.direction.column[2] = cross(l.direction.column[0], l.direction.column[1]);
  return l;
}

grid::Grid<std::int16_t> numbered(const grid::Lattice& l) {
  grid::Grid<std::int16_t> g(l);
  for (std::size_t i = 0; i < g.voxels.size(); ++i) g.voxels[i] = static_cast<std::int16_t>(i);
  return g;
}

TEST(Grid, IndexAndWorldAreInverse) {
  const grid::Lattice l = oblique();
  const Vec3 back = l.to_index(l.to_world_mm({1.5, 2.25, 3.75}));
  EXPECT_NEAR(back.x, 1.5, 1e-12);
  EXPECT_NEAR(back.y, 2.25, 1e-12);
  EXPECT_NEAR(back.z, 3.75, 1e-12);
}

TEST(Grid, CropKeepsVoxelsAndPositions) {
  const auto g = numbered(oblique());
  const grid::Box box{{2, 1, 3}, {6, 5, 5}};
  const auto part = grid::crop(g, box);
  ASSERT_EQ(part.size, (std::array<int, 3>{4, 4, 2}));
  for (int k = 0; k < 2; ++k)
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 4; ++i) EXPECT_EQ(part.at(i, j, k), g.at(i + 2, j + 1, k + 3));
  EXPECT_NEAR(norm(part.to_world_mm({1, 1, 1}) - g.to_world_mm({3, 2, 4})), 0, 1e-12);
  const grid::Box place = grid::place_in(part, g);
  EXPECT_EQ(place.begin, box.begin);
  EXPECT_EQ(place.end, box.end);
  EXPECT_THROW(grid::crop(g, grid::Box{{0, 0, 0}, {8, 1, 1}}), Error);
}

TEST(Grid, FitCutsOffAndFillsUp) {
  const auto g = numbered(oblique());
  grid::Lattice shifted = grid::cropped(g, grid::Box{{-2, 3, 0}, {4, 9, 5}});
  const auto out = grid::fit(g, shifted, std::int16_t{-1});
  ASSERT_EQ(out.size, (std::array<int, 3>{6, 6, 5}));
  for (int k = 0; k < 5; ++k)
    for (int j = 0; j < 6; ++j)
      for (int i = 0; i < 6; ++i) EXPECT_EQ(out.at(i, j, k), g.contains(i - 2, j + 3, k) ? g.at(i - 2, j + 3, k) : -1);
  grid::Lattice far = g;
  far.origin_mm = g.to_world_mm({100, 0, 0});
  for (const auto v : grid::fit(g, far, std::int16_t{-7}).voxels) EXPECT_EQ(v, -7);
}

TEST(Grid, AnotherRasterIsRefused) {
  const grid::Lattice l = oblique();
  const auto code_of = [&](const grid::Lattice& part) {
    try {
      grid::place_in(part, l);
    } catch (const Error& e) {
      return e.code();
    }
    return ExitCode::ok;
  };
  EXPECT_EQ(code_of(l), ExitCode::ok);
  grid::Lattice half = l;
  half.origin_mm = l.to_world_mm({0.5, 0, 0});
  EXPECT_EQ(code_of(half), ExitCode::bad_input);
  grid::Lattice coarser = l;
  coarser.spacing_mm.z *= 1.001;
  EXPECT_EQ(code_of(coarser), ExitCode::bad_input);
  grid::Lattice turned = l;
  turned.direction = Mat3();
  EXPECT_EQ(code_of(turned), ExitCode::bad_input);
  grid::Lattice broken = l;
  broken.origin_mm.x = std::nan("");
  EXPECT_EQ(code_of(broken), ExitCode::bad_input);
}

TEST(Grid, GrownStaysWithin) {
  const grid::Lattice l = oblique();
  const grid::Box b = grid::grown({{1, 2, 3}, {2, 3, 4}}, 3, l);
  EXPECT_EQ(b.begin, (std::array<int, 3>{0, 0, 0}));
  EXPECT_EQ(b.end, (std::array<int, 3>{5, 6, 5}));
  EXPECT_EQ(grid::whole_box(l).end, l.size);
}

}  // namespace
}  // namespace trephine
