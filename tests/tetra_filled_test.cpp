// SPDX-License-Identifier: GPL-3.0-or-later
#include "tetra/program/filled.h"

#include <gtest/gtest.h>

#include <algorithm>

using namespace trephine;

namespace {

// A cube of unit side at x, in six tetrahedra along its diagonal (Kuhn).
void add_cube(tetra::Filled& f, double x, std::uint8_t region) {
  const auto first = std::uint32_t(f.points.size());
  for (int n = 0; n < 8; ++n) f.points.push_back({x + (n & 1), double(n >> 1 & 1), double(n >> 2)});
  std::array<int, 3> way{0, 1, 2};
  do {
    std::array<std::uint32_t, 4> t{first, first, first, first};
    for (std::size_t n = 0; n < 3; ++n) t[n + 1] = t[n] + (1u << way[n]);
    const Vec3 a = f.points[t[0]];
    if (dot(cross(f.points[t[1]] - a, f.points[t[2]] - a), f.points[t[3]] - a) < 0) std::swap(t[1], t[2]);
    f.tetrahedra.push_back(t);
    f.region_of.push_back(region);
  } while (std::next_permutation(way.begin(), way.end()));
}

double volume(const tetra::Filled& f, std::size_t n) {
  const auto& t = f.tetrahedra[n];
  const Vec3 a = f.points[t[0]];
  return dot(cross(f.points[t[1]] - a, f.points[t[2]] - a), f.points[t[3]] - a) / 6;
}

}  // namespace

// A tetrahedron of another region within a cube goes to the cube's; a region that is no larger stays.
TEST(TetraFilled, LoneCellsJoin) {
  tetra::Filled f;
  add_cube(f, 0, 1);
  add_cube(f, 10, 2);
  add_cube(f, 20, 3);
  f.region_of[2] = 2;   // a piece of region 2 within region 1
  f.region_of[14] = 4;  // all that there is of region 4
  EXPECT_EQ(1u, tetra::join_lone_cells(f));
  EXPECT_EQ(1, f.region_of[2]);
  EXPECT_EQ(4, f.region_of[14]);
}

// The same cells in another order, and each with its corners in another even order, are the same mesh.
TEST(TetraFilled, OrderIsOfTheContent) {
  tetra::Filled f;
  add_cube(f, 0, 1);
  add_cube(f, 10, 2);
  const tetra::Filled once = tetra::in_order(f);
  tetra::Filled other;
  for (std::size_t n = f.points.size(); n-- > 0;) other.points.push_back(f.points[n]);
  for (std::size_t n = f.tetrahedra.size(); n-- > 0;) {
    std::array<std::uint32_t, 4> t = f.tetrahedra[n];
    for (std::uint32_t& c : t) c = std::uint32_t(f.points.size() - 1 - c);
    std::rotate(t.begin() + 1, t.begin() + 2, t.end());
    if (n % 2) {
      std::swap(t[0], t[3]);
      std::swap(t[1], t[2]);
    }
    other.tetrahedra.push_back(t);
    other.region_of.push_back(f.region_of[n]);
  }
  const tetra::Filled again = tetra::in_order(other);
  EXPECT_EQ(once.points, again.points);
  EXPECT_EQ(once.tetrahedra, again.tetrahedra);
  EXPECT_EQ(once.region_of, again.region_of);
  for (std::size_t n = 0; n < once.tetrahedra.size(); ++n) EXPECT_NEAR(1.0 / 6, volume(once, n), 1e-12);
}

// Two cubes that touch by nothing: twelve triangles around each, which look outwards.
TEST(TetraFilled, BordersLookOutwards) {
  tetra::Filled f;
  add_cube(f, 0, 1);
  add_cube(f, 10, 2);
  tetra::add_borders(f);
  ASSERT_EQ(24u, f.borders.size());
  double enclosed = 0;
  for (std::size_t n = 0; n < f.borders.size(); ++n) {
    EXPECT_EQ(0, f.between[n][1]);
    const auto& t = f.borders[n];
    enclosed += dot(f.points[t[0]], cross(f.points[t[1]], f.points[t[2]])) / 6;
  }
  EXPECT_NEAR(2, enclosed, 1e-12);
}
