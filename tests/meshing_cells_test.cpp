// SPDX-License-Identifier: GPL-3.0-or-later
// The check of what marching cubes made looks in the cells beside each triangle's own, without a search tree. It finds
// what the tree finds.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"
#include "meshing/validity.h"
#include "meshing_shapes.h"
#include "surface/cell_rows.h"
#include "surface/incidence.h"

namespace trephine {
namespace {

using namespace shapes;

/// Voxels of unequal sides, in any direction, left-handed or not.
grid::Field turned_noise(std::uint64_t seed) {
  Random random(seed);
  const double fill = random(0.05, 0.45);
  grid::Field f = noise(6 + int(9 * random()), seed, fill, random() < 0.3);
  f.spacing_mm = {random(0.3, 1), random(0.3, 1), random(0.5, 4)};
  f.origin_mm = random.direction() * 300;
  const Vec3 x = random.direction(), z = normalized(cross(x, random.direction()));
  f.direction.column = {x, cross(z, x), random() < 0.5 ? z : z * -1};
  return f;
}

std::array<int, 3> cell_of(const surface::TriMesh& mesh, const grid::Lattice& lattice, std::uint32_t triangle) {
  const auto& t = mesh.triangles[triangle];
  const Vec3 p = lattice.to_index((mesh.world_mm(t[0]) + mesh.world_mm(t[1]) + mesh.world_mm(t[2])) / 3);
  return {int(std::floor(p.x)), int(std::floor(p.y)), int(std::floor(p.z))};
}

/// Moves some points by up to a fifth of a voxel, so that triangles meet. Their centres stay in their cells.
void disturb(surface::TriMesh& mesh, const grid::Lattice& lattice, Random& random) {
  const surface::Incidence incidence(mesh);
  for (std::uint32_t p = 0; p < mesh.points_mm.size(); ++p) {
    if (random() < 0.6) continue;
    const Vec3 d = random.direction() * random(0, 0.2), before = mesh.points_mm[p], s = lattice.spacing_mm;
    for (std::uint32_t n = incidence.begin[p]; n < incidence.begin[p + 1]; ++n) {
      const std::uint32_t t = incidence.triangle[n];
      const auto cell = cell_of(mesh, lattice, t);
      const Vec3 now = mesh.points_mm[p];
      mesh.points_mm[p] = before + lattice.direction * Vec3{d.x * s.x, d.y * s.y, d.z * s.z};
      const bool stays = cell_of(mesh, lattice, t) == cell;
      mesh.points_mm[p] = now;
      if (!stays) break;
      if (n + 1 == incidence.begin[p + 1])
        mesh.points_mm[p] = before + lattice.direction * Vec3{d.x * s.x, d.y * s.y, d.z * s.z};
    }
  }
}

/// Returns how many pairs of intersecting triangles there are.
std::size_t compare(const grid::Field& field, bool disturbed, std::uint64_t seed) {
  surface::TriMesh mesh = contoured(field);
  Random random(seed + 1000);
  if (disturbed) disturb(mesh, field, random);
  const surface::TriMesh& m = mesh;
  EXPECT_TRUE(surface::CellRows::of(m, field)) << "field " << seed;
  const surface::Incidence incidence(m);
  const auto by_tree = meshing::self_intersections(m, incidence);
  EXPECT_EQ(meshing::self_intersections(m, incidence, field), by_tree) << "field " << seed;
  const meshing::Validity v = meshing::check_validity(m, {}, &field);
  EXPECT_EQ(v.self_intersections, by_tree.size());
  EXPECT_EQ(v.valid(), meshing::check_validity(m).valid());
  return by_tree.size();
}

void compare_many(std::uint64_t from, std::uint64_t to) {
  std::size_t pairs = 0;
  for (std::uint64_t seed = from; seed < to; ++seed) {
    EXPECT_EQ(compare(turned_noise(seed), false, seed), 0u);
    pairs += compare(turned_noise(seed), true, seed);
  }
  EXPECT_GT(pairs, 10 * (to - from));
}

TEST(Cells, FindWhatTheTreeFinds) { compare_many(0, 60); }
TEST(LongCells, FindWhatTheTreeFinds) { compare_many(60, 1000); }

TEST(Cells, FindItWithAnyThreads) {
  grid::Field f = noise(40, 3, 0.3, false);
  set_thread_count(1);
  const std::size_t one = compare(f, true, 5);
  set_thread_count(2);
  EXPECT_EQ(compare(f, true, 5), one);
  set_thread_count(0);
  EXPECT_GT(one, 1000u);
}

TEST(Cells, KeepTheirOrderWhenPiecesAreDropped) {
  const grid::Field f = noise(24, 9, 0.2, false);
  meshing::ContourParams p;
  p.min_component_mm3 = 5;
  const surface::TriMesh m = meshing::contour(f, p).value;
  EXPECT_LT(m.triangles.size(), contoured(f).triangles.size());
  EXPECT_TRUE(surface::CellRows::of(m, f));
}

TEST(Cells, AreNotUsedForOtherSurfaces) {
  const grid::Field f = noise(12, 4, 0.3, false);
  surface::TriMesh m = contoured(f);
  Random random(8);
  disturb(m, f, random);
  const auto pairs = [&](const surface::TriMesh& mesh) {
    return meshing::self_intersections(mesh, surface::Incidence(mesh), f).size();
  };
  const std::size_t expected = pairs(m);
  ASSERT_GT(expected, 0u);
  // The same triangles in another order.
  surface::TriMesh exchanged = m;
  const std::size_t third = m.triangles.size() / 3;
  std::swap(exchanged.triangles[third], exchanged.triangles[2 * third]);
  EXPECT_FALSE(surface::CellRows::of(exchanged, f));
  EXPECT_EQ(pairs(exchanged), expected);
  EXPECT_FALSE(surface::CellRows::of({}, f));
}

TEST(Cells, AreNotUsedForTrianglesThatReachBeyond) {
  // Two triangles that cross, with centres four cells apart.
  const grid::Lattice l = lattice(12, 12, 12);
  surface::TriMesh m;
  m.points_mm = {{-2.5, 5.2, 5.2}, {6.5, 5.2, 5.8}, {3.5, 5.8, 5.5}, {12.5, 5.5, 5.2}, {2, 5.5, 5.1}, {4, 5.5, 5.95}};
  m.triangles = {{0, 1, 2}, {3, 4, 5}};
  EXPECT_FALSE(surface::CellRows::of(m, l));
  EXPECT_EQ(meshing::self_intersections(m, surface::Incidence(m), l).size(), 1u);
  m.triangles.pop_back();
  m.points_mm = {{2.1, 5.2, 5.2}, {2.9, 5.2, 5.8}, {2.5, 5.8, 5.5}};
  EXPECT_TRUE(surface::CellRows::of(m, l));
}

}  // namespace
}  // namespace trephine
