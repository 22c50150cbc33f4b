// SPDX-License-Identifier: GPL-3.0-or-later
// Removal as a rate: how much, of what, and that nothing rises.
#include <gtest/gtest.h>

#include "base/error.h"
#include "drill_scene.h"

using namespace trephine;
using namespace trephine::drilling;

namespace {

// A stroke of 2 s through material, along two sides of a square, at 20 mm/s.
Vec3 on_stroke(Vec3 middle, double t) {
  return t < 1 ? middle + Vec3{-10 + 20 * t, 2, -1} : middle + Vec3{10, 2 - 20 * (t - 1), -1};
}

double stroked_mm3(double rate_hz, double radius) {
  voxel::HapticVolume v = full(72, 0.6);
  const Vec3 m = middle(v);
  drill::DrillParams params;
  params.power_w = 5;
  drill::Drill drill(v, only(1, 0.1), ball(radius), params);
  std::int64_t units = 0;
  const int ticks = int(2 * rate_hz);
  for (int n = 0; n <= ticks; ++n)
    units += cut(drill, centred(on_stroke(m, n / rate_hz), radius), 1 / rate_hz).units[1];
  return mm3(v, units);
}

}  // namespace

// "What must be shown", 1
TEST(Drill, RemovesTheSameWhateverTheTicksLength) {
  const double at_1000 = stroked_mm3(1000, 1.5);
  std::printf("  250, 1000, 4000 Hz:");
  for (const double rate : {250.0, 1000.0, 4000.0}) {
    const double is = stroked_mm3(rate, 1.5);
    std::printf(" %.4f", is);
    EXPECT_NEAR(is / at_1000, 1, 3e-3) << rate;
  }
  std::printf(" mm3\n");
  EXPECT_GT(at_1000, 50);
}

// 2: a ball that is moved through new material all the time: 20 W at 0.1 J/mm3 are 200 mm3/s.
TEST(Drill, APowerIsARate) {
  for (const double energy : {0.1, 0.2}) {
    voxel::HapticVolume v = full(80, 0.6);
    const Vec3 m = middle(v);
    drill::Drill drill(v, only(1, energy), ball(2.5), {});
    std::int64_t units = 0;
    double energy_j = 0;
    for (int n = 0; n <= 1000; ++n) {
      const drill::Removal& r = cut(drill, centred(m + Vec3{-10 + 0.02 * n, 0.3, 0.2}, 2.5), 0.001);
      units += r.units[1];
      energy_j += r.energy_j;
    }
    EXPECT_NEAR(mm3(v, units), 20 / energy, 0.02 * 20 / energy);
    EXPECT_NEAR(energy_j, 20, 0.4);
  }
  // Half of the power, and none.
  voxel::HapticVolume v = full(80, 0.6);
  const Vec3 m = middle(v);
  drill::Drill drill(v, only(1, 0.1), ball(2.5), {});
  std::int64_t half = 0, none = 0;
  for (int n = 0; n <= 500; ++n) half += cut(drill, centred(m + Vec3{-10 + 0.02 * n, 0, 0}, 2.5), 0.001, 0.5).units[1];
  for (int n = 0; n <= 100; ++n) none += cut(drill, centred(m + Vec3{0.02 * n, 0, 0}, 2.5), 0.001, 0).units[1];
  EXPECT_NEAR(mm3(v, half), 50, 0.8);
  EXPECT_EQ(none, 0);
}

// Hardness: half as hard, twice as fast, by the share that is declared for the softest.
TEST(Drill, HardMaterialTakesMore) {
  double removed[2];
  for (const int hardness : {0, 255}) {
    voxel::HapticVolume v = full(60, 0.6);
    v.hardness = grid::Mask(v.voxels, std::uint8_t(hardness));
    const Vec3 m = middle(v);
    drill::DrillParams params;
    params.soft_energy_ratio = 0.25;
    params.power_w = 1;
    drill::Drill drill(v, only(1, 0.1), ball(2), params);
    std::int64_t units = 0;
    for (int n = 0; n <= 2000; ++n) units += cut(drill, centred(m + Vec3{-5 + 0.005 * n, 0, 0}, 2), 0.001).units[1];
    removed[hardness == 0 ? 0 : 1] = mm3(v, units);
  }
  EXPECT_NEAR(removed[0] / removed[1], 4, 0.1);
}

namespace {

// After each of many cuts at the borders of three shapes: no shape's occupancy is higher anywhere than before.
void random_cuts(int count) {
  std::mt19937_64 rng(4);
  voxel::HapticVolume v = layers(36, 0.5);
  auto drill = std::make_unique<drill::Drill>(v, of_layers(), ball(0.8), drill::DrillParams{});
  drill::Removal all;
  int risen = 0, touched = 0;
  for (int n = 0; n < count; ++n) {
    if (n % 2000 == 1999) {
      v = layers(36, 0.5);
      drill = std::make_unique<drill::Drill>(v, of_layers(), ball(uniform(rng, 0.4, 1.2)), drill::DrillParams{});
    }
    const Vec3 at = v.voxels.to_world_mm({uniform(rng, 3, 33), uniform(rng, 3, 33), uniform(rng, 8, 34)});
    const grid::Grid<std::int16_t> before = v.voxels;
    const bool incision = n % 200 == 199;
    grid::Box changed;
    if (incision) {
      drill->incise(at, 1.5);
      while (drill->incising()) {
        const drill::Removal& r = drill->go_on();
        if (!r.changed.empty()) changed = r.changed;
        EXPECT_EQ(r.units[2] + r.units[3], 0) << "an incision cuts skin";
      }
      changed = changed.empty() ? changed : grid::whole_box(v.voxels);
    } else {
      drill->rest();
      const drill::ToolPose pose = centred(at, drill->cutter().radius_mm);
      const drill::Removal& r = drill->cut_way(pose, pose.tip_mm + Vec3{0.1, 0, 0.1}, 0, 0.02);
      changed = r.changed;
      EXPECT_EQ(r.units[1], 0) << "a drill cuts no skin";
      EXPECT_EQ(r.units[3], 0) << "nor brain";
    }
    const grid::Box box = grid::grown(changed, 2, v.voxels);
    for (int k = box.begin[2]; k < box.end[2]; ++k)
      for (int j = box.begin[1]; j < box.end[1]; ++j)
        for (int i = box.begin[0]; i < box.end[0]; ++i) {
          const std::int16_t was = before.at(i, j, k), is = v.voxels.at(i, j, k);
          if (changed.empty()) continue;
          touched += was != is;
          for (int shape = 1; shape <= 3; ++shape) {
            const int had = voxel::detail::share_of(before, shape, i, j, k),
                      has = voxel::detail::share_of(v.voxels, shape, i, j, k);
            risen += has > had;
            if (shape == 3 && !incision) risen += has < had;
          }
        }
  }
  EXPECT_EQ(risen, 0);
  EXPECT_GT(touched, count);
}

}  // namespace

// 4
TEST(Drill, NoVoxelRisesOrChangesItsShape) { random_cuts(6000); }
TEST(LongDrill, AHundredThousandCutsRaiseNothing) { random_cuts(100000); }

// A flap: all skin within the radius goes, in shares of 4,000 voxels, and nothing else does.
TEST(Drill, AnIncisionRemovesTheSkinWithinARadius) {
  voxel::HapticVolume v = layers(80, 0.5);
  const grid::Grid<std::int16_t> before = v.voxels;
  drill::Drill drill(v, of_layers(), ball(2), {});
  const Vec3 at = v.voxels.to_world_mm({40, 40, 60});
  EXPECT_FALSE(drill.incising());
  drill.incise(at, 12);
  int calls = 0;
  std::int64_t units = 0;
  for (; drill.incising() && calls < 1000; ++calls) units += drill.go_on().units[1];
  EXPECT_FALSE(drill.incising());
  EXPECT_GT(calls, 5) << "not all at once";
  EXPECT_GT(units, 0);
  int left = 0, beyond = 0, others = 0;
  for (int k = 0; k < 80; ++k)
    for (int j = 0; j < 80; ++j)
      for (int i = 0; i < 80; ++i) {
        const double d = norm(v.voxels.to_world_mm({double(i), double(j), double(k)}) - at);
        const int had = voxel::detail::share_of(before, 1, i, j, k),
                  has = voxel::detail::share_of(v.voxels, 1, i, j, k);
        if (d < 11.99) left += has;
        if (d > 13.2) beyond += had != has;
        const voxel::detail::RawVoxel was = voxel::detail::split(before.at(i, j, k)),
                                      is = voxel::detail::split(v.voxels.at(i, j, k));
        if (was.number > 1) others += was.number != is.number || was.share != is.share;
      }
  EXPECT_EQ(left, 0);
  EXPECT_EQ(beyond, 0);
  EXPECT_EQ(others, 0);
}

TEST(Drill, WhatCannotBeDrilledIsRefused) {
  voxel::HapticVolume v = full(8, 1);
  EXPECT_THROW(drill::Drill(v, only(1, 0.1), ball(0), {}), Error);
  EXPECT_THROW(drill::Drill(v, only(1, 0.1), ball(25), {}), Error);
}
