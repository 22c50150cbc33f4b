// SPDX-License-Identifier: GPL-3.0-or-later
// Dice and the voxels inside of a mesh, against analytic solids.
#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "base/pi.h"
#include "metrics/overlap.h"
#include "surface/inside.h"
#include "surface_shapes.h"

namespace trephine {
namespace {

grid::Lattice lattice(int ni, int nj, int nk, double spacing, Vec3 origin = {}) {
  grid::Lattice l;
  l.size = {ni, nj, nk};
  l.spacing_mm = {spacing, spacing, spacing};
  l.origin_mm = origin;
  return l;
}

grid::Mask box_mask(const grid::Lattice& l, std::array<int, 3> from, std::array<int, 3> to) {
  grid::Mask m(l);
  for (int k = from[2]; k < to[2]; ++k)
    for (int j = from[1]; j < to[1]; ++j)
      for (int i = from[0]; i < to[0]; ++i) m.at(i, j, k) = 3;
  return m;
}

std::size_t count(const grid::Mask& m) {
  return m.voxels.size() - std::size_t(std::count(m.voxels.begin(), m.voxels.end(), 0));
}

TEST(Dice, ShiftedBoxes) {
  const grid::Lattice l = lattice(40, 30, 20, 0.5);
  const grid::Mask a = box_mask(l, {5, 5, 5}, {15, 15, 15});
  for (int shift = 0; shift <= 12; ++shift) {
    const grid::Mask b = box_mask(l, {5 + shift, 5, 5}, {15 + shift, 15, 15});
    EXPECT_DOUBLE_EQ(metrics::dice(a, b), std::max(0, 10 - shift) / 10.0);
  }
  EXPECT_EQ(metrics::dice(grid::Mask(l), grid::Mask(l)), 1);
  EXPECT_EQ(metrics::dice(a, grid::Mask(l)), 0);
  EXPECT_DOUBLE_EQ(metrics::volume_mm3(a), 125);
}

TEST(Dice, PartsOfOneRaster) {
  const grid::Lattice l = lattice(40, 30, 20, 0.5, {3, 4, 5});
  const grid::Mask a = box_mask(l, {5, 5, 5}, {15, 15, 15});
  const grid::Mask b = box_mask(l, {10, 5, 5}, {20, 15, 15});
  const grid::Mask part = grid::crop(b, grid::Box{{8, 3, 4}, {22, 17, 16}});
  EXPECT_DOUBLE_EQ(metrics::dice(a, part), metrics::dice(a, b));
  EXPECT_DOUBLE_EQ(metrics::dice(part, a), metrics::dice(a, b));
  EXPECT_THROW(metrics::dice(a, grid::Mask(lattice(40, 30, 20, 0.6))), Error);
}

TEST(Dice, OneLabelOfMany) {
  grid::Mask m = box_mask(lattice(10, 10, 10, 1), {0, 0, 0}, {5, 10, 10});
  m.at(9, 9, 9) = 7;
  EXPECT_EQ(count(metrics::select_label(m, 3)), 500u);
  EXPECT_EQ(count(metrics::select_label(m, 7)), 1u);
  EXPECT_EQ(count(metrics::select_label(m, 0)), 501u);
  EXPECT_EQ(count(metrics::select_label(m, 9)), 0u);
}

TEST(Voxelize, SphereVoxelByVoxel) {
  // Oblique, anisotropic, left-handed lattice; every voxel off the shell between facets and sphere is known.
  const double radius = 20, c = std::cos(0.4), s = std::sin(0.4);
  const Vec3 centre{50.3, -20.1, 7.7};
  const surface::TriMesh m = shapes::sphere(5, radius, centre);
  grid::Lattice l = lattice(70, 80, 50, 1);
  l.spacing_mm = {0.7, 0.6, 1.1};
  l.direction.column = {Vec3{c, s, 0}, Vec3{s, -c, 0}, Vec3{0, 0, 1}};
  l.origin_mm = centre - l.direction * Vec3{24, 25, 27};
  const grid::Mask inside = surface::voxelize_inside(m, l);
  std::size_t wrong = 0, known = 0;
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i) {
        const double d = norm(l.to_world_mm({double(i), double(j), double(k)}) - centre) - radius;
        if (d < 0 && d > -0.02) continue;
        ++known;
        wrong += (inside.at(i, j, k) != 0) != (d < 0);
      }
  EXPECT_EQ(wrong, 0u);
  EXPECT_GT(known, l.count() - 500);
  EXPECT_NEAR(metrics::volume_mm3(inside) / (4 * pi / 3 * radius * radius * radius), 1, 0.005);
}

TEST(Voxelize, FacesThroughLatticePoints) {
  // A box whose faces, edges and corners hold voxel centres: half-open, so exactly 10 x 20 x 5, nothing leaks.
  const grid::Mask inside = surface::voxelize_inside(shapes::box({5, 5, 5}, {15, 25, 10}), lattice(30, 40, 20, 1));
  EXPECT_EQ(count(inside), 10u * 20 * 5);
  // Two boxes that share a face share no voxel and leave none out.
  const grid::Mask next = surface::voxelize_inside(shapes::box({15, 5, 5}, {20, 25, 10}), lattice(30, 40, 20, 1));
  const grid::Mask both = surface::voxelize_inside(shapes::box({5, 5, 5}, {20, 25, 10}), lattice(30, 40, 20, 1));
  EXPECT_EQ(metrics::dice(inside, next), 0);
  EXPECT_EQ(count(inside) + count(next), count(both));
}

TEST(Voxelize, OctahedronWithAllItsCornersOnTheLattice) {
  // Every edge and corner meets rows exactly.
  surface::TriMesh m;
  m.points_mm = {{8, 0, 0}, {-8, 0, 0}, {0, 8, 0}, {0, -8, 0}, {0, 0, 8}, {0, 0, -8}};
  m.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  const grid::Lattice l = lattice(21, 21, 21, 1, {-10, -10, -10});
  const grid::Mask inside = surface::voxelize_inside(m, l);
  for (int k = -10; k <= 10; ++k)
    for (int j = -10; j <= 10; ++j)
      for (int i = -10; i <= 10; ++i) {
        const int r = std::abs(i) + std::abs(j) + std::abs(k);
        if (r != 8) {
          ASSERT_EQ(inside.at(i + 10, j + 10, k + 10) != 0, r < 8) << i << " " << j << " " << k;
        }
      }
}

TEST(Voxelize, NothingLeaksFromRoughMeshesOnAnyLattice) {
  const surface::TriMesh m = shapes::lumpy(5);
  for (int n = 0; n < 8; ++n) {
    const grid::Lattice l = lattice(50, 45, 48, 4.1 + 0.3 * n, {-100.0 - n, -100, -101});
    const grid::Mask inside = surface::voxelize_inside(m, l);
    EXPECT_NEAR(metrics::volume_mm3(inside), surface::volume_mm3(m), 0.02 * surface::volume_mm3(m));
    for (int k = 0; k < l.size[2]; ++k)
      for (int j = 0; j < l.size[1]; ++j) ASSERT_EQ(inside.at(49, j, k), 0);
  }
}

TEST(Voxelize, WhatLiesBeyondTheLatticeIsCutOff) {
  const grid::Mask inside =
      surface::voxelize_inside(shapes::box({-50, -50, -50}, {50, 50, 4.5}), lattice(10, 10, 10, 1));
  EXPECT_EQ(count(inside), 500u);
  EXPECT_EQ(count(surface::voxelize_inside(shapes::box({50, 50, 50}, {60, 60, 60}), lattice(10, 10, 10, 1))), 0u);
  EXPECT_EQ(count(surface::voxelize_inside(surface::TriMesh{}, lattice(10, 10, 10, 1))), 0u);
}

TEST(Voxelize, OpenMeshesAndBadPointsAreRefused) {
  surface::TriMesh m = shapes::box({2, 2, 2}, {8, 8, 8});
  m.triangles.erase(m.triangles.begin() + 9);  // one of the faces that rows run through
  EXPECT_THROW(surface::voxelize_inside(m, lattice(10, 10, 10, 1)), Error);
  m = shapes::box({2, 2, 2}, {8, 8, 8});
  m.points_mm[0].x = std::nan("");
  EXPECT_THROW(surface::voxelize_inside(m, lattice(10, 10, 10, 1)), Error);
}

}  // namespace
}  // namespace trephine
