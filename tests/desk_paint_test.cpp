// SPDX-License-Identifier: GPL-3.0-or-later
// What the desk's brush asks of the rooms: what hangs together in a ball, the slices between painted ones, painted
// bytes.
#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "desk/patches.h"
#include "mask/between_slices.h"
#include "segmentation/grow.h"
#include "surface/plane_cut.h"

namespace trephine {
namespace {

grid::Lattice lattice_of(std::array<int, 3> size, Vec3 spacing = {1, 1, 1}) {
  grid::Lattice l;
  l.size = size;
  l.spacing_mm = spacing;
  l.origin_mm = {-10, 5, 3};
  return l;
}

// A disc of that radius in voxels in slice k.
void disc(grid::Mask& mask, int k, double x, double y, double radius, std::uint8_t value = 1) {
  for (int j = 0; j < mask.size[1]; ++j)
    for (int i = 0; i < mask.size[0]; ++i)
      if (std::hypot(i - x, j - y) <= radius) mask.at(i, j, k) = value;
}

int count_in(const grid::Mask& mask, int k, std::uint8_t value = 1) {
  int n = 0;
  for (int j = 0; j < mask.size[1]; ++j)
    for (int i = 0; i < mask.size[0]; ++i) n += mask.at(i, j, k) == value;
  return n;
}

TEST(desk_between, AConeGrowsEvenly) {
  grid::Mask painted(lattice_of({41, 41, 12}, {0.5, 0.5, 2}));
  disc(painted, 1, 20, 20, 5);
  disc(painted, 9, 20, 20, 13);
  const grid::Mask made = mask::between_slices(painted, 1, 2);
  for (int k = 2; k < 9; ++k) {
    const double radius = 5 + 8 * (k - 1) / 8.0, area = M_PI * radius * radius;
    EXPECT_NEAR(count_in(made, k), area, 0.12 * area) << k;
  }
  EXPECT_EQ(count_in(made, 1), count_in(painted, 1));
  EXPECT_EQ(count_in(made, 9), count_in(painted, 9));
  EXPECT_EQ(count_in(made, 0) + count_in(made, 10) + count_in(made, 11), 0) << "nothing beyond the ends";
}

TEST(desk_between, AShapeThatLeansIsFollowed) {
  grid::Mask painted(lattice_of({60, 30, 9}));
  disc(painted, 0, 10, 15, 6);
  disc(painted, 8, 45, 15, 6);  // the two do not overlap
  const grid::Mask made = mask::between_slices(painted, 1, 2);
  for (int k = 1; k < 8; ++k) {
    EXPECT_NEAR(count_in(made, k), count_in(painted, 0), 15) << k;  // half a voxel of its rim
    EXPECT_EQ(made.at(int(std::lround(10 + 35 * k / 8.0)), 15, k), 1) << k;
  }
}

TEST(desk_between, AlongEveryAxisAndAtTheEdge) {
  for (int axis = 0; axis < 3; ++axis) {
    std::array<int, 3> size{20, 20, 20};
    size[std::size_t(axis)] = 5;
    grid::Mask painted(lattice_of(size));
    std::array<int, 3> at{0, 0, 0};
    const auto set = [&](int slice) {
      for (at[0] = 0; at[0] < size[0]; ++at[0])
        for (at[1] = 0; at[1] < size[1]; ++at[1])
          for (at[2] = 0; at[2] < size[2]; ++at[2])
            if (at[std::size_t(axis)] == slice && at[std::size_t((axis + 1) % 3)] < 7)
              painted.at(at[0], at[1], at[2]) = 2;  // to the lattice's edge
    };
    set(0);
    set(4);
    const grid::Mask made = mask::between_slices(painted, 2, axis);
    std::size_t n = 0;
    for (const std::uint8_t v : made.voxels) n += v == 2;
    EXPECT_EQ(n, 5u * 7u * 20u) << axis;
  }
}

TEST(desk_between, WhatIsPaintedOtherwiseStays) {
  grid::Mask painted(lattice_of({20, 20, 5}));
  disc(painted, 0, 10, 10, 6);
  disc(painted, 4, 10, 10, 6);
  painted.at(10, 10, 2) = 2;
  const grid::Mask made = mask::between_slices(painted, 1, 2);
  EXPECT_EQ(made.at(10, 10, 2), 2);
  EXPECT_EQ(made.at(11, 10, 2), 1);
}

TEST(desk_between, WithoutAGapItSaysSo) {
  grid::Mask painted(lattice_of({20, 20, 5}));
  disc(painted, 1, 10, 10, 6);
  EXPECT_THROW(mask::between_slices(painted, 1, 2), Error);
  disc(painted, 2, 10, 10, 6);
  EXPECT_THROW(mask::between_slices(painted, 1, 2), Error);
  EXPECT_THROW(mask::between_slices(painted, 1, 3), Error);
}

TEST(desk_grow, WhatHangsTogetherInTheBall) {
  grid::Grid<std::int16_t> volume(lattice_of({30, 30, 30}, {1, 1, 2}), 0);
  for (int k = 0; k < 30; ++k)
    for (int j = 0; j < 30; ++j)
      for (int i = 0; i < 30; ++i)
        if (i < 14 || i > 16) volume.at(i, j, k) = 500;  // two blocks with a gap
  segmentation::GrowRequest request;
  request.seed = {10, 15, 15};
  request.radius_mm = 8;
  request.lower_hu = 300;
  request.upper_hu = 700;
  const grid::Mask grown = segmentation::grow_in_ball(volume, request);
  const Vec3 seed = volume.to_world_mm({10, 15, 15});
  std::size_t n = 0, within = 0;
  for (int k = 0; k < 30; ++k)
    for (int j = 0; j < 30; ++j)
      for (int i = 0; i < 14; ++i) within += norm(volume.to_world_mm({double(i), double(j), double(k)}) - seed) <= 8;
  for (int k = 0; k < grown.size[2]; ++k)
    for (int j = 0; j < grown.size[1]; ++j)
      for (int i = 0; i < grown.size[0]; ++i)
        if (grown.at(i, j, k)) {
          ++n;
          EXPECT_LE(norm(grown.to_world_mm({double(i), double(j), double(k)}) - seed), 8);
        }
  EXPECT_EQ(n, within) << "all of the seed's block in the ball, and nothing beyond the gap";
  request.seed = {15, 15, 15};
  EXPECT_THROW(segmentation::grow_in_ball(volume, request), Error) << "the gap itself is not in the range";
}

TEST(desk_painted, ComesBackAsItWent) {
  const grid::Lattice scan = lattice_of({20, 10, 8}, {0.5, 0.7, 2});
  grid::Box box;
  box.begin = {3, 4, 5};
  box.end = {9, 8, 8};
  grid::Mask voxels(grid::cropped(scan, box));
  voxels.at(1, 2, 0) = 1;
  voxels.at(5, 3, 2) = 2;
  const std::string bytes = desk::encode_painted(voxels, scan);
  EXPECT_EQ(desk::decode_painted(bytes, scan), voxels);
  for (std::size_t n = 0; n < bytes.size(); ++n) EXPECT_THROW(desk::decode_painted(bytes.substr(0, n), scan), Error);
  std::string beyond = bytes;
  beyond[0] = 15;
  EXPECT_THROW(desk::decode_painted(beyond, scan), Error) << "six voxels from 15 on are beyond 20";
  std::string other = bytes;
  other.back() = 3;
  EXPECT_THROW(desk::decode_painted(other, scan), Error);
}

TEST(desk_cut, ThePlaneMeetsTheSurfaceInALoop) {
  surface::TriMesh octahedron;  // of radius 10 about its origin
  octahedron.origin_mm = {100, 200, 300};
  octahedron.points_mm = std::vector<Vec3>{{10, 0, 0}, {-10, 0, 0}, {0, 10, 0}, {0, -10, 0}, {0, 0, 10}, {0, 0, -10}};
  octahedron.triangles = std::vector<std::array<std::uint32_t, 3>>{{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                                                   {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (const double z : {-6.0, 0.0, 4.0}) {
    double length = 0;
    for (const auto& [a, b] : surface::plane_cut(octahedron, {0, 0, 300 + z}, {0, 0, 2})) {
      EXPECT_NEAR(a.z, 300 + z, 1e-9);
      EXPECT_NEAR(b.z, 300 + z, 1e-9);
      length += norm(a - b);
    }
    EXPECT_NEAR(length, 4 * std::sqrt(2.0) * (10 - std::abs(z)), 1e-9) << z;
  }
  EXPECT_TRUE(surface::plane_cut(octahedron, {0, 0, 311}, {0, 0, 1}).empty());
}

}  // namespace
}  // namespace trephine
