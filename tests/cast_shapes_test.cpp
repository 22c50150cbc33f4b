// SPDX-License-Identifier: GPL-3.0-or-later
// The reference ray caster sees the shapes of a haptic volume where they are felt.
#include "cast/cast_shapes.h"

#include <gtest/gtest.h>

#include <random>

#include "cast_phantoms.h"
#include "cast_shapes.h"
#include "voxel/decode.h"
#include "voxel/voxel_shapes.h"

namespace trephine::casting {
namespace {

constexpr int side = 60;

// Where a ray comes to a place of which `there` says so, by halving between steps of a 20th of a voxel.
template <class There>
double first_place(const scene::EyeView& eye, Vec3 direction, double from, double to, double step, const There& there) {
  for (double t = from; t < to; t += step) {
    if (!there(eye.eye_mm + direction * t)) continue;
    double low = t - step, high = t;
    for (int n = 0; n < 20; ++n) {
      const double middle = (low + high) / 2;
      (there(eye.eye_mm + direction * middle) ? high : low) = middle;
    }
    return high;
  }
  return std::numeric_limits<double>::infinity();
}

// Sight and touch of each of three shapes, as those before it are clear.
TEST(CastShapes, BeginWhereTheyAreFelt) {
  const Nested n = nested(40);
  const voxel::HapticDecoder decoder(n.volume);
  const double voxel_mm = n.volume.voxels.spacing_mm.x;
  cast::CastShapes shapes(n.volume, n.haptic);
  for (int shape = 1; shape <= 3; ++shape) {
    const cast::CastBricks bricks(shapes);
    for (const Vec3 toward : {Vec3{0.3, -0.5, 0.8}, Vec3{1, 0.05, 0.02}}) {
      const scene::EyeView eye = eye_at(n.volume.voxels, toward, 16);
      const cast::CastPicture p = cast::cast_rays(shapes, bricks, eye, side, side);
      int seen = 0, off = 0;
      for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
          const Vec3 d = eye.ray(x + 0.5, y + 0.5, side, side);
          const double felt = first_place(eye, d, 170, 230, 0.05 * voxel_mm,
                                          [&](Vec3 at) { return decoder.trilinear(shape, at) >= 0.5; });
          const double is = double(p.begins_mm[std::size_t(y * side + x)]);
          if (!std::isfinite(felt)) continue;
          // By the edge of a ball a ray runs along its surface: what it is off counts across that.
          const double across = std::abs(dot(d, normalized(decoder.gradient(shape, eye.eye_mm + d * felt))));
          ++seen;
          off += !(std::abs(is - felt) * across <= 0.05 * voxel_mm);
        }
      EXPECT_GT(seen, side * side / 8) << shape;
      EXPECT_LE(off, seen / 500) << shape;
    }
    shapes.set_opacity(shape, 0);
  }
  const cast::CastPicture none =
      cast::cast_rays(shapes, cast::CastBricks(shapes), eye_at(n.volume.voxels, {0, 0, 1}, 16), side, side);
  for (const std::array<float, 4>& rgba : none.rgba) EXPECT_EQ(rgba[3], 0);
}

TEST(CastShapes, HaveTheColoursOfTheirMaterials) {
  const Nested n = nested(40);
  cast::CastShapes shapes(n.volume, n.haptic);
  shapes.set_opacity(1, 0.05);
  const scene::EyeView eye = eye_at(n.volume.voxels, {0, 0, 1}, 4);
  const auto middle = [&] { return cast::cast_rays(shapes, cast::CastBricks(shapes), eye, 3, 3).rgba[4]; };
  const auto behind_veil = middle();  // red before green
  EXPECT_GT(behind_veil[0], 0.05);
  EXPECT_GT(behind_veil[1], behind_veil[0]);
  EXPECT_LT(behind_veil[2], 0.2 * behind_veil[1]);
  EXPECT_GT(behind_veil[3], 0.99);
  shapes.set_opacity(1, 0);
  EXPECT_LT(middle()[0], 0.2 * middle()[1]);
}

// Voxels of four shapes without any order, full, in parts and bare.
voxel::HapticVolume noise() {
  std::mt19937 rng(5);
  voxel::HapticVolume v;
  v.voxels = grid::Grid<std::int16_t>(lattice(12, 0.7));
  for (int n = 1; n <= 4; ++n) v.shapes.push_back(voxel::occupancy_shape("s" + std::to_string(n), n));
  for (std::int16_t& raw : v.voxels.voxels)
    if (rng() % 4 != 0)
      raw = std::int16_t(1000 * (1 + int(rng() % 4)) + (rng() % 3 == 0 ? 300 : 0) + 1 + int(rng() % 255));
  return v;
}

// Whatever the volume holds, a voxel is read as the hand's decoder reads it.
TEST(CastShapes, VoxelsAreThoseOfTheDecoder) {
  const voxel::HapticVolume v = noise();
  const voxel::HapticDecoder decoder(v);
  for (int k = 0; k < v.voxels.size[2]; ++k)
    for (int j = 0; j < v.voxels.size[1]; ++j)
      for (int i = 0; i < v.voxels.size[0]; ++i) {
        const voxel::VoxelShapes is = voxel::shapes_of_voxel(v.voxels, i, j, k);
        for (int n = 1; n <= 4; ++n) {
          const int share = n == is.number ? is.share : n == is.rest ? 255 - is.share : 0;
          ASSERT_NEAR(share / 255.0, decoder.occupancy(n, i, j, k), 1e-6) << i << " " << j << " " << k << " " << n;
        }
      }
}

// And so is what lies between voxels, where several shapes meet and none may have half of a place.
TEST(CastShapes, PlacesAreThoseOfTheDecoder) {
  const voxel::HapticVolume v = noise();
  const voxel::HapticDecoder decoder(v);
  cases::CaseHaptic haptic;
  for (const voxel::HapticShape& s : v.shapes) {
    haptic.shapes.emplace_back();
    haptic.shapes.back().number = s.number;
  }
  const cast::CastShapes shapes(v, haptic);
  const Vec3 middle = middle_of(v.voxels), half{2, 2, 2};
  cast::CastParams params;
  params.step_mm = 0.01;
  params.box = surface::Bounds{middle - half, middle + half};
  const scene::EyeView eye = eye_at(v.voxels, {0, 0, 1}, 3);
  constexpr int few = 16;
  const cast::CastPicture p = cast::cast_rays(shapes, cast::CastBricks(shapes), eye, few, few, params);
  int off = 0;
  for (int y = 0; y < few; ++y)
    for (int x = 0; x < few; ++x) {
      const Vec3 d = eye.ray(x + 0.5, y + 0.5, few, few);
      const double felt = first_place(eye, d, 197.9, 202.1, 0.005, [&](Vec3 at) {
        if (std::abs(at.z - middle.z) > 2) return false;
        bool any = false;
        for (int n = 1; n <= 4; ++n) any = any || decoder.trilinear(n, at) >= 0.5;
        return any;
      });
      const double is = double(p.begins_mm[std::size_t(y * few + x)]);
      off += !(is == felt || std::abs(is - felt) <= 0.02);
    }
  EXPECT_LE(off, few * few / 50);
}

TEST(CastShapes, FollowCuts) {
  Nested n = nested(40);
  cast::CastShapes shapes(n.volume, n.haptic);
  cast::CastBricks bricks(shapes);
  const grid::Box box{{9, 14, 20}, {25, 22, 40}};
  for (int k = box.begin[2]; k < box.end[2]; ++k)
    for (int j = box.begin[1]; j < box.end[1]; ++j)
      for (int i = box.begin[0]; i < box.end[0]; ++i) n.volume.voxels.at(i, j, k) = voxel::haptic_empty;
  bricks.look(shapes, shapes.follow(n.volume, box));
  const cast::CastShapes anew(n.volume, n.haptic);
  const cast::CastBricks bricks_anew(anew);
  for (std::size_t i = 0; i < anew.voxels().voxels.size(); ++i) {
    const auto &a = anew.voxels().voxels[i], &is = shapes.voxels().voxels[i];
    ASSERT_TRUE(a.number == is.number && a.share == is.share && a.rest == is.rest);
  }
  for (std::size_t i = 0; i < bricks.clear.size(); ++i) ASSERT_EQ(bricks.clear[i] == 0, bricks_anew.clear[i] == 0);
  const scene::EyeView eye = eye_at(n.volume.voxels, {0.2, -0.4, 0.9}, 30);
  EXPECT_EQ(cast::cast_rays(shapes, bricks, eye, side, side).rgba,
            cast::cast_rays(anew, bricks_anew, eye, side, side).rgba);
  cast::CastParams every;
  every.leave_out_empty = false;
  EXPECT_EQ(cast::cast_rays(shapes, bricks, eye, side, side, every).rgba,
            cast::cast_rays(anew, bricks_anew, eye, side, side).rgba);
}

}  // namespace
}  // namespace trephine::casting
