// SPDX-License-Identifier: GPL-3.0-or-later
// The reference ray caster on phantoms whose surfaces are known.
#include "cast/ray_cast.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "base/parallel.h"
#include "cast_phantoms.h"

namespace trephine::casting {
namespace {

const Vec3 sides[] = {{0.3, -0.5, 0.8}, {1, 0.05, 0.02}, {-0.6, -0.7, -0.3}, {0, 0, 1}};
constexpr double spacing = 0.8, voxels = 0.05;  // of one: how far a surface may lie from where it is

double ball_at(Vec3 eye, Vec3 direction, Vec3 middle, double radius) {
  const Vec3 m = eye - middle;
  const double b = dot(m, direction), c = dot(m, m) - radius * radius, root = b * b - c;
  return root > 0 ? -b - std::sqrt(root) : std::numeric_limits<double>::infinity();
}

// The share of the rays through the inner part of a ball that begin to see it elsewhere.
double astray(const grid::Grid<std::int16_t>& v, const voxel::TransferFunction& f, double radius, Vec3 side) {
  const scene::EyeView eye = eye_at(v, side, 2.4 * radius);
  constexpr int n = 60;
  const cast::CastPicture p = cast_of(v, f, eye, n);
  int seen = 0, off = 0;
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      const Vec3 d = eye.ray(x + 0.5, y + 0.5, n, n);
      if (!std::isfinite(ball_at(eye.eye_mm, d, middle_of(v), 0.9 * radius))) continue;
      ++seen;
      const double is = double(p.begins_mm[std::size_t(y * n + x)]);
      off += !(std::abs(norm(eye.eye_mm + d * is - middle_of(v)) - radius) <= voxels * v.spacing_mm.x);
    }
  EXPECT_GT(seen, n * n / 4);
  return double(off) / seen;
}

TEST(Cast, OpacityBeginsWhereTheFunctionSaysOnABall) {
  const grid::Grid<std::int16_t> v = ball(lattice(70, 0.4), 12, 100);
  for (const Vec3 side : sides)
    for (const double hu : {-50.0, 0.0, 227.0}) {
      EXPECT_EQ(astray(v, ramp(hu, hu + 300), 12 - hu / 100, side), 0) << hu;
      EXPECT_EQ(astray(v, voxel::window_function(int(hu), 3000, {1, 1, 1}), 12 - hu / 100, side), 0) << hu;
    }
}

TEST(Cast, OpacityBeginsWhereTheFunctionSaysOnStepsAndRamps) {
  const Vec3 normal = normalized(Vec3{0.4, 0.3, 0.87});
  const grid::Lattice l = lattice(40, spacing);
  const Vec3 middle = middle_of(l);
  for (const double hu_per_mm : {20.0, 200.0, 500.0}) {  // a ramp over the volume, and steps of a voxel and less
    const grid::Grid<std::int16_t> v =
        filled(l, [&](Vec3 p) { return std::clamp(hu_per_mm * dot(normal, middle - p), -1000.0, 1000.0); });
    for (const Vec3 side : {sides[0], sides[3]})
      for (const double hu : {-90.0, 0.0, 80.0}) {
        const scene::EyeView eye = eye_at(l, side, 10);
        constexpr int n = 30;
        const cast::CastPicture p = cast_of(v, ramp(hu, hu + 50), eye, n);
        int off = 0;
        for (int y = 0; y < n; ++y)
          for (int x = 0; x < n; ++x) {
            const Vec3 d = eye.ray(x + 0.5, y + 0.5, n, n);
            const double is = double(p.begins_mm[std::size_t(y * n + x)]);
            const double truth = dot(normal, middle - normal * (hu / hu_per_mm) - eye.eye_mm) / dot(normal, d);
            off += !(std::abs(is - truth) * std::abs(dot(normal, d)) <= voxels * spacing);
          }
        EXPECT_EQ(off, 0) << hu_per_mm << " " << hu;
      }
  }
}

TEST(Cast, ALayerLetsThroughWhatItsOpacitySays) {
  const grid::Lattice l = lattice(40, spacing);
  const grid::Grid<std::int16_t> v(l, 500);
  const double side_mm = spacing * l.size[0];
  scene::EyeView eye = eye_at(l, l.direction.column[0], 4);
  for (const double opacity : {0.01, 0.05, 0.1}) {
    const cast::CastPicture p = cast_of(v, ramp(100, 200, opacity), eye, 3);
    EXPECT_NEAR(p.rgba[4][3], 1 - std::pow(1 - opacity, side_mm), 1e-3) << opacity;
    cast::CastParams finer;
    finer.step_mm = 0.11;
    EXPECT_NEAR(cast_of(v, ramp(100, 200, opacity), eye, 3, finer).rgba[4][3], p.rgba[4][3], 1e-3);
  }
}

TEST(Cast, WhatIsEmptyChangesNothing) {
  std::mt19937_64 rng(7);
  const grid::Lattice l = lattice(45, spacing);
  grid::Grid<std::int16_t> v = ball(l, 9, 120);
  for (int n = 0; n < 40; ++n) v.voxels[rng() % v.voxels.size()] = 900;
  cast::CastParams every;
  every.leave_out_empty = false;
  for (const Vec3 side : sides) {
    const scene::EyeView eye = eye_at(l, side, 50);
    const cast::CastPicture a = cast_of(v, ramp(100, 400, 0.4), eye, 70),
                            b = cast_of(v, ramp(100, 400, 0.4), eye, 70, every);
    EXPECT_EQ(a.rgba, b.rgba);
    EXPECT_EQ(a.begins_mm, b.begins_mm);
  }
  const cast::CastTable table({ramp(100, 400)});
  const cast::CastBricks bricks(v, table);
  EXPECT_LT(std::count(bricks.clear.begin(), bricks.clear.end(), 0), std::ptrdiff_t(bricks.clear.size() / 2));
  // Each is as far from what is shown as it says.
  for (int n = 0; n < 300; ++n) {
    const int at[3] = {int(rng() % std::uint64_t(bricks.size[0])), int(rng() % std::uint64_t(bricks.size[1])),
                       int(rng() % std::uint64_t(bricks.size[2]))};
    int nearest = 255;
    for (int k = 0; k < bricks.size[2]; ++k)
      for (int j = 0; j < bricks.size[1]; ++j)
        for (int i = 0; i < bricks.size[0]; ++i)
          if (bricks.clear[bricks.index(i, j, k)] == 0)
            nearest = std::min(nearest, std::max({std::abs(i - at[0]), std::abs(j - at[1]), std::abs(k - at[2])}));
    EXPECT_EQ(bricks.clear[bricks.index(at[0], at[1], at[2])], nearest);
  }
}

// A cut looks again at the bricks that read it, and what is filled again is shown again.
TEST(Cast, BricksFollowCuts) {
  const grid::Lattice l = lattice(45, spacing);
  const grid::Grid<std::int16_t> before = ball(l, 9, 120);
  grid::Grid<std::int16_t> v = before;
  const cast::CastTable table({ramp(100, 400)});
  const cast::CastBricks bricks(v, table);
  cast::CastBricks follows = bricks;
  const grid::Box box{{7, 9, 8}, {24, 30, 30}};
  for (int k = box.begin[2]; k < box.end[2]; ++k)
    for (int j = box.begin[1]; j < box.end[1]; ++j)
      for (int i = box.begin[0]; i < box.end[0]; ++i) v.at(i, j, k) = -1024;
  follows.look(v, table, box);
  const cast::CastBricks anew(v, table);
  EXPECT_NE(anew.clear, bricks.clear);
  for (std::size_t n = 0; n < anew.clear.size(); ++n) {
    EXPECT_EQ(follows.clear[n] == 0, anew.clear[n] == 0);
    EXPECT_LE(follows.clear[n], anew.clear[n]) << "rays would leave out what is shown";
  }
  follows.look(before, table, box);
  EXPECT_EQ(follows.clear, bricks.clear);
}

TEST(Cast, EndsAtSurfacesPlanesAndTheBox) {
  const grid::Lattice l = lattice(44, spacing);
  const grid::Grid<std::int16_t> v = ball(l, 12, 100);
  const scene::EyeView eye = eye_at(l, sides[0], 20);
  constexpr int n = 21, middle = n * n / 2;
  const auto f = ramp(0, 100, 0.3);
  const cast::CastPicture whole = cast_of(v, f, eye, n);
  ASSERT_GT(whole.rgba[middle][3], 0.9);
  cast::CastParams params;
  params.surface_mm.assign(n * n, 187);  // the ball begins at 188
  EXPECT_EQ(cast_of(v, f, eye, n, params).rgba[middle][3], 0);
  params.surface_mm.assign(n * n, 190);
  const float before = cast_of(v, f, eye, n, params).rgba[middle][3];
  EXPECT_GT(before, 0.1);
  EXPECT_LT(before, 0.6);
  // The far half remains, and begins at the plane.
  cast::CastParams cut;
  cut.cut = scene::CutPlane{middle_of(l), eye.toward};
  EXPECT_NEAR(cast_of(v, f, eye, n, cut).begins_mm[middle], 200, 1e-3);
  cut.cut->normal = -eye.toward;
  EXPECT_NEAR(cast_of(v, f, eye, n, cut).begins_mm[middle], whole.begins_mm[middle], 1e-3);
  EXPECT_LT(cast_of(v, f, eye, n, cut).rgba[middle][3], whole.rgba[middle][3]);
  cast::CastParams boxed;
  boxed.box = surface::Bounds{middle_of(l) - Vec3{3, 3, 3}, middle_of(l) + Vec3{3, 3, 3}};
  const cast::CastPicture in_box = cast_of(v, f, eye, n, boxed);
  EXPECT_GT(in_box.begins_mm[middle], 190);
  EXPECT_EQ(in_box.rgba[0][3], 0);
  // What the volume's border cuts is closed.
  const grid::Grid<std::int16_t> full(l, 500);
  EXPECT_LT(cast_of(full, f, eye, n).begins_mm[middle], 200);
}

TEST(Cast, TheSameBytesOnAnyNumberOfThreads) {
  const grid::Grid<std::int16_t> v = ball(lattice(30, spacing), 8, 100);
  const scene::EyeView eye = eye_at(v, sides[2], 20);
  const auto once = [&](int threads) {
    set_thread_count(threads);
    return cast_of(v, ramp(0, 200, 0.5), eye, 40);
  };
  const cast::CastPicture one = once(1), three = once(3);
  set_thread_count(0);
  EXPECT_EQ(one.rgba, three.rgba);
  EXPECT_EQ(one.hides_mm, three.hides_mm);
}

TEST(Cast, SeveralFunctionsAreSeenAtOnce) {
  voxel::TransferFunction red = ramp(0, 100, 0.5), blue = ramp(50, 100, 0.5);
  for (auto& p : red.points) p.colour_rgb = {1, 0, 0};
  for (auto& p : blue.points) p.colour_rgb = {0, 0, 1};
  const cast::CastTable table({red, blue});
  EXPECT_NEAR(table.at(200)[3], 0.75, 1e-6);
  EXPECT_NEAR(table.at(200)[0], 0.5, 1e-6);
  EXPECT_NEAR(table.at(25)[3], 0.125, 1e-6);
  EXPECT_NEAR(table.at(25)[2], 0, 1e-6);
  EXPECT_EQ(table.at(-3000)[3], 0);
  EXPECT_FALSE(table.sees(-2000, 0));
  EXPECT_TRUE(table.sees(-2000, 1));
  EXPECT_TRUE(table.sees(4000, 5000));
}

}  // namespace
}  // namespace trephine::casting
