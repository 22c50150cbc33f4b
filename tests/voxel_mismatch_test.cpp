// SPDX-License-Identifier: GPL-3.0-or-later
// Seen against felt, where the truth is known.
#include <gtest/gtest.h>

#include "base/error.h"
#include "base/parallel.h"
#include "report_of.h"
#include "voxel/mismatch.h"
#include "voxel_shapes.h"

namespace trephine {
namespace {

voxel::HapticVolume volume_of(const surface::TriMesh& surface, const grid::Lattice& lattice) {
  Report report;
  return value_of(report, voxel::voxelize(lattice, {{"a", &surface}}));
}

TEST(Mismatch, OfABallThatIsSeenLargerOrSmaller) {
  std::mt19937_64 rng(1);
  const auto ball = shapes::ball(10, {3, 2, 1}, 0, rng);
  const grid::Lattice l = shapes::lattice_around(surface::bounds_of(ball.mesh), {0.4, 0.4, 0.95}, shapes::turned(rng));
  const voxel::HapticVolume v = volume_of(ball.mesh, l);
  for (const double seen : {10.0, 10.7, 8.5}) {
    const voxel::Mismatch m = voxel::measure_mismatch(shapes::sphere(5, seen, {3, 2, 1}), v, v.shapes[0]);
    EXPECT_EQ(m.samples, 20000u);
    EXPECT_EQ(m.missed_ratio, 0);
    EXPECT_NEAR(m.bias_mm, 10 - seen, 0.02);
    EXPECT_NEAR(m.rms_mm, std::abs(10 - seen), 0.02);
    EXPECT_NEAR(m.p99_mm, std::abs(10 - seen), 0.05);
    EXPECT_LE(m.p99_mm, m.max_mm);
    EXPECT_LT(m.max_mm, std::abs(10 - seen) + 0.1);
  }
  // Seen off to one side: the offsets are the shift's part along the normal, a third of its square on average.
  const voxel::Mismatch off = voxel::measure_mismatch(shapes::sphere(5, 10, {3, 2.6, 1}), v, v.shapes[0]);
  EXPECT_NEAR(off.bias_mm, 0, 0.02);
  EXPECT_NEAR(off.rms_mm, 0.6 / std::sqrt(3.0), 0.02);
  EXPECT_NEAR(off.max_mm, 0.6, 0.06);
  // Farther away than the reach.
  const voxel::Mismatch far = voxel::measure_mismatch(shapes::sphere(5, 6, {3, 2, 1}), v, v.shapes[0]);
  EXPECT_EQ(far.missed_ratio, 1);
  EXPECT_EQ(far.samples, 20000u);
  voxel::MismatchParams params;
  params.reach_mm = 5;
  EXPECT_EQ(voxel::measure_mismatch(shapes::sphere(5, 6, {3, 2, 1}), v, v.shapes[0], params).missed_ratio, 0);
  EXPECT_EQ(voxel::measure_mismatch(surface::TriMesh{}, v, v.shapes[0]).samples, 0u);
}

TEST(Mismatch, TheFarSideOfAThinWallIsNotTheSurfaceSeen) {
  std::mt19937_64 rng(2);
  const auto felt = shapes::block({9, 9, 0.75}, {0, 0, 0}, {}, 0, 0, rng);
  const voxel::HapticVolume v =
      volume_of(felt.mesh, shapes::lattice_around(surface::bounds_of(felt.mesh), {0.5, 0.5, 0.5}));
  // A plane that faces +z, seen 0.2 mm below the wall's lower face: the upper face is 1.7 mm away, the lower 0.2.
  const surface::TriMesh seen = [] {
    surface::TriMesh m = shapes::plane(8, -0.95, 4);
    m.origin_mm = {-4, -4, 0};
    return m;
  }();
  const voxel::Mismatch m = voxel::measure_mismatch(seen, v, v.shapes[0]);
  EXPECT_NEAR(m.bias_mm, 1.7, 0.02);
  EXPECT_NEAR(m.rms_mm, 1.7, 0.02);
}

TEST(Mismatch, OnlyWithinTheRegionAndTheSameForAnyThreadCount) {
  std::mt19937_64 rng(3);
  const auto ball = shapes::ball(10, {}, 0, rng);
  const grid::Lattice whole = shapes::lattice_around(surface::bounds_of(ball.mesh), {0.8, 0.8, 0.8});
  grid::Box half = grid::whole_box(whole);
  half.end[2] /= 2;
  const voxel::HapticVolume v = volume_of(ball.mesh, grid::cropped(whole, half));
  voxel::Mismatch m[2];
  for (const int threads : {1, 2}) {
    set_thread_count(threads);
    m[threads - 1] = voxel::measure_mismatch(ball.mesh, v, v.shapes[0]);
  }
  set_thread_count(0);
  EXPECT_GT(m[0].samples, 8000u);
  EXPECT_LT(m[0].samples, 10000u);
  EXPECT_EQ(m[0].missed_ratio, 0);
  EXPECT_LT(m[0].max_mm, 0.2);  // the cap at the region's border is not what is seen
  EXPECT_EQ(m[0].rms_mm, m[1].rms_mm);
  EXPECT_EQ(m[0].bias_mm, m[1].bias_mm);
  surface::TriMesh bad = ball.mesh;
  bad.points_mm[3].x = NAN;
  EXPECT_THROW(voxel::measure_mismatch(bad, v, v.shapes[0]), Error);
}

}  // namespace
}  // namespace trephine
