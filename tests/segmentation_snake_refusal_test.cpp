// SPDX-License-Identifier: GPL-3.0-or-later
// What a snake refuses to begin with, what it refuses to give, and the leaks that it warns of.
#include <gtest/gtest.h>

#include <limits>

#include "report_of.h"
#include "segmentation/bubbles.h"
#include "segmentation/speed_image.h"
#include "segmentation_snake_evolved.h"

namespace trephine {
namespace {

using namespace segmentation_test;

TEST(Snake, BubblesAreReadStrictly) {
  const auto two = segmentation::parse_bubbles("1,2,3,4; -1.5, 0 ,2e1,0.5");
  ASSERT_EQ(two.size(), 2u);
  EXPECT_EQ(two[1].centre_mm, (Vec3{-1.5, 0, 20}));
  EXPECT_EQ(two[1].radius_mm, 0.5);
  for (const char* bad : {"", ";", "1,2,3", "1,2,3,4,5", "1,2,3,0", "1,2,3,-4", "1,2,3,nan", "1,2,3,4;", "1 2 3 4",
                          "1,2,3,0x4", "1e7,0,0,1", "a,b,c,d"})
    EXPECT_EQ(error_of([&] { segmentation::parse_bubbles(bad); }).code(), ExitCode::usage) << bad;
}

TEST(Snake, NothingToBeginWithIsRefused) {
  const grid::Lattice l = lattice({20, 20, 20}, {1, 1, 1});
  const grid::Field speed = ball_speed(l, 6);
  const auto refused = [&](const segmentation::SnakeParams& p, const segmentation::SnakeMasks& masks = {}) {
    return error_of([&] { segmentation::snake(speed, masks, p); });
  };
  segmentation::SnakeParams p;
  EXPECT_EQ(refused(p).code(), ExitCode::usage);
  p.bubbles = "0,0,0,3";
  p.bubbles_count = 1;
  EXPECT_EQ(refused(p).code(), ExitCode::usage);
  p.bubbles_count = 0;
  p.bubbles = "100,0,0,3";  // outside the volume
  EXPECT_EQ(refused(p).code(), ExitCode::quality);
  EXPECT_NE(std::string(refused(p).what()).find("ball 1"), std::string::npos);
  EXPECT_NE(std::string(refused(p).what()).find("x -10 to 10"), std::string::npos) << "where the speed image lies";
  p.bubbles = "0,0,0,3;8.5,8.5,8.5,1";  // the second outside the structure
  EXPECT_EQ(refused(p).code(), ExitCode::quality);
  EXPECT_NE(std::string(refused(p).what()).find("ball 2"), std::string::npos);
  p.bubbles.clear();
  const grid::Field nothing(l, -1.f);
  EXPECT_EQ(refused(p, {&nothing, nullptr, nullptr}).code(), ExitCode::quality);
  EXPECT_EQ(refused(p, {&speed, &nothing, nullptr}).code(), ExitCode::quality);
  p.propagation = p.curvature = 0;
  EXPECT_EQ(refused(p, {&speed, nullptr, nullptr}).code(), ExitCode::usage);
}

TEST(Snake, ALeakIsRefusedByItsVolumeAndWarnedOfAtTheEdge) {
  // A ball with a hole in its wall into a slab that leaves the volume.
  const grid::Lattice l = lattice({50, 30, 30}, {0.7, 0.7, 0.7});
  const grid::Field speed = sampled(l, [](Vec3 p) {
    const double in = 8 - norm(p + Vec3{10, 0, 0});
    const double hole = 2 - norm(Vec3{0, p.y, p.z});
    return soft(std::max({in, p.x > -10 ? hole : -9.0, p.x - 5}));
  });
  segmentation::SnakeParams p;
  p.bubbles = "-10,0,0,5";
  const Evolved leaked = run(speed, p);
  ASSERT_FALSE(leaked.report.warnings.empty());
  EXPECT_NE(leaked.report.warnings[0].find("edge"), std::string::npos);
  p.max_volume_ml = 4;
  const Error e = error_of([&] { segmentation::snake(speed, {}, p); });
  EXPECT_EQ(e.code(), ExitCode::quality);
  EXPECT_EQ(e.field(), "max_volume_ml");
}

TEST(Snake, AGeodesicSnakeStaysWithinThePresegmentationsMask) {
  // No edge anywhere: what holds the surface is the speed's -1 outside of presegment's `within` alone.
  const grid::Lattice l = lattice({40, 40, 40}, {0.9, 0.9, 2});
  Noise noise(11);
  const grid::Grid<float> volume = sampled(l, [&](Vec3) { return 30 + noise.gaussian(); });
  const grid::Field within = sampled(l, [](Vec3 p) { return 13 - norm(p - centre); });
  segmentation::PresegmentParams edges;
  edges.method = segmentation::PresegmentMethod::edges;
  edges.edge_kappa_hu_per_mm = 5;
  Report report;
  const grid::Field speed = value_of(report, segmentation::presegment(volume, {&within, nullptr}, edges));
  segmentation::SnakeParams p;
  p.method = segmentation::SnakeMethod::geodesic;
  p.bubbles = "0,0,0,6";
  const Evolved r = run(speed, p);
  const grid::Field mask = grid::fit(within, static_cast<const grid::Lattice&>(r.field), -1.f);
  std::size_t outside = 0;
  for (std::size_t v = 0; v < mask.count(); ++v) outside += r.field.voxels[v] > 0 && !(mask.voxels[v] > 0);
  EXPECT_EQ(outside, 0u);
  EXPECT_GT(dice(r.field, within), 0.98) << "and fills it";
  // Nothing in the image holds it, and that is said.
  EXPECT_GT(figure(r, "held_by_limits_ratio"), 0.9);
  ASSERT_EQ(r.report.warnings.size(), 1u);
  EXPECT_NE(r.report.warnings[0].find("100 % of its surface rest on the limits"), std::string::npos);
}

TEST(Snake, ALeakThroughNoiseOrUpToAMaskIsSaid) {
  // Fluid of 0 HU in tissue of 20, noise of 12: a window that takes half of the tissue in leaks into all of it.
  const grid::Lattice l = lattice({60, 50, 50}, {0.8, 0.8, 0.8});
  Noise noise(9);
  const grid::Grid<float> volume =
      sampled(l, [&](Vec3 p) { return (norm(p) < 9 ? 0.0 : 20.0) + 12 * noise.gaussian(); });
  const grid::Field within = sampled(l, [](Vec3 p) { return 20 - norm(p); });
  const auto evolved = [&](double upper_hu, double sigma_mm) {
    segmentation::PresegmentParams window;
    window.lower_hu = -40;
    window.upper_hu = upper_hu;
    window.smoothing_sigma_mm = sigma_mm;
    segmentation::SnakeParams p;
    p.bubbles = "0,0,0,5";
    return run(segmentation::presegment(volume, {&within, nullptr}, window).value, p, {nullptr, &within, nullptr});
  };
  const auto warned = [](const Evolved& r, const char* of) {
    for (const std::string& w : r.report.warnings)
      if (w.find(of) != std::string::npos) return true;
    return false;
  };
  const Evolved good = evolved(10, 0.8), noisy = evolved(25, 0.4);
  EXPECT_TRUE(good.report.warnings.empty());
  EXPECT_NEAR(figure(good, "volume_ml"), 3.05, 0.2);
  EXPECT_GT(figure(noisy, "volume_ml"), 6);
  EXPECT_TRUE(warned(noisy, "the speed is negative"));
  // Without presegment's: the speed goes on beyond the mask.
  const grid::Field all(l, 0.8f);
  segmentation::SnakeParams p;
  p.bubbles = "0,0,0,5";
  const Evolved held = run(all, p, {nullptr, &within, nullptr});
  EXPECT_GT(figure(held, "held_by_limits_ratio"), 0.9);
  EXPECT_TRUE(warned(held, "rest on the limits"));
}

TEST(Snake, WhatVanishesFillsAllOrLosesItsStructureIsRefused) {
  const grid::Lattice l = lattice({20, 20, 20}, {0.8, 0.8, 0.8});
  const grid::Field start = sampled(l, [](Vec3 p) { return 5 - norm(p); });
  segmentation::SnakeParams p;
  p.max_iterations_count = 1000;
  const auto refused = [&](const grid::Field& speed) {
    return error_of([&] { segmentation::evolve_snake(speed, start, p); });
  };
  EXPECT_EQ(refused(grid::Field(l, -1.f)).field(), "start");
  EXPECT_EQ(refused(grid::Field(l, 1.f)).field(), "speed");
  EXPECT_EQ(refused(grid::Field(l, 1.f)).code(), ExitCode::quality);
  p.min_mean_speed = 0.5;
  p.max_iterations_count = 1;
  EXPECT_EQ(refused(grid::Field(l, 0.1f)).field(), "min_mean_speed");
}

TEST(Snake, NoNumberNoHuAndNoOtherRasterGetIn) {
  const grid::Lattice l = lattice({20, 20, 20}, {1, 1, 1});
  const grid::Field good = ball_speed(l, 6);
  const auto code = [&](const grid::Field& speed, const grid::Field& start) {
    return error_of([&] { segmentation::evolve_snake(speed, start, {}); }).code();
  };
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), 40.f}) {
    grid::Field speed = good;
    speed.at(3, 4, 5) = bad;
    EXPECT_EQ(code(speed, good), ExitCode::bad_input) << bad;
    if (bad != 40.f) {
      EXPECT_EQ(code(good, speed), ExitCode::bad_input) << bad;
    }
  }
  grid::Field other = good;
  other.spacing_mm.x = 1.1;
  EXPECT_EQ(code(good, other), ExitCode::bad_input);
}

}  // namespace
}  // namespace trephine
