// SPDX-License-Identifier: GPL-3.0-or-later
// evolve_snake and snake: where the surface comes to rest against closed forms, extremes, the same bytes by threads.
#include "segmentation/snake.h"

#include <gtest/gtest.h>

#include <limits>

#include "base/parallel.h"
#include "segmentation/bubbles.h"
#include "segmentation/speed_image.h"
#include "snake_shapes.h"

namespace trephine {
namespace {

using namespace snake_test;

constexpr Vec3 centre{0.2, -0.3, 0.4};

/// The speed of a shape of signed distance d (positive inside), its edge blurred.
double soft(double d) { return std::tanh(d); }
Field ball_speed(const Lattice& l, double radius) {
  return sampled(l, [&](Vec3 p) { return soft(radius - norm(p - centre)); });
}

struct Evolved {
  Field field;
  Report report;
};
Evolved run(const Field& speed, const SnakeParams& p, const SnakeMasks& masks = {}) {
  Evolved r;
  r.field = snake(speed, masks, p, r.report);
  for (const float v : r.field.voxels) EXPECT_TRUE(std::isfinite(v) && v != 0);
  return r;
}
std::string stopped_by(const Evolved& r) { return std::get<std::string>(*r.report.find("stopped_by")); }
double figure(const Evolved& r, const char* name) { return std::get<double>(*r.report.find(name)); }

TEST(Snake, ABubbleGrowsToTheEdgeOfABall) {
  const double radius = 14;
  for (const Vec3 spacing : {Vec3{0.5, 0.5, 0.5}, Vec3{0.7, 0.7, 1.5}, Vec3{0.3, 0.3, 5}}) {
    SnakeParams p;
    p.bubbles = "3,2,1,6";
    p.curvature = 0;
    const Evolved r = run(ball_speed(lattice({40, 40, 50}, spacing), radius), p);
    EXPECT_EQ(stopped_by(r), "converged");
    const Deviation d = deviation(r.field, [&](Vec3 x) { return norm(x - centre) - radius; });
    // Between slices 5 mm apart the speed itself knows no better.
    const double slack = spacing.z == 5 ? 0.15 : 0.05;
    EXPECT_LT(std::abs(d.mean), slack * spacing.x + (spacing.z == 5 ? 0.02 : 0));
    EXPECT_LT(d.rms, 0.12 * spacing.z);
    EXPECT_NEAR(figure(r, "volume_ml"), 4.0 / 3 * M_PI * std::pow(radius, 3) / 1000, 0.12);
  }
}

TEST(Snake, CurvatureDrawsABallInByTheBalanceOfForces) {
  // At rest: tanh(R - r) = 0.6 * 2 / r.
  const double radius = 10, weight = 0.6;
  double rest = radius;
  for (int i = 0; i < 50; ++i) rest = radius - std::atanh(2 * weight / rest);
  SnakeParams p;
  p.bubbles = "0,0,0,7";
  p.curvature = weight;
  p.min_change_mm = 0.0002;
  const Evolved r = run(ball_speed(lattice({26, 26, 26}, {0.5, 0.5, 0.5}), radius), p);
  const Deviation d = deviation(r.field, [&](Vec3 x) { return norm(x - centre) - rest; });
  EXPECT_LT(std::abs(d.mean), 0.02) << rest;
  EXPECT_LT(d.max, 0.06);
}

TEST(Snake, NoiseAndBlurLeaveAnEllipsoidAndACapsuleWithinAFractionOfAVoxel) {
  // HU of CSF 8 in tissue 32, noise of 8 HU at 0.6 mm; a window, and its snake with ITK-SNAP's weights.
  const Lattice l = lattice({50, 40, 40}, {0.6, 0.6, 0.9});
  const Vec3 a{15, 9, 8};
  const auto ellipsoid = [&](Vec3 p) {
    const Vec3 q{p.x / a.x, p.y / a.y, p.z / a.z}, g{q.x / a.x, q.y / a.y, q.z / a.z};
    return norm(q) > 0 ? norm(q) * (1 - norm(q)) / norm(g) : a.z;  // distance to first order
  };
  const auto capsule = [&](Vec3 p) { return 6 - norm(p - Vec3{std::clamp(p.x, -12.0, 12.0), 0, 0}); };
  PresegmentParams window;
  window.lower_hu = -30;
  window.upper_hu = 20;
  window.smoothing_sigma_mm = 0.8;
  SnakeParams p;
  p.bubbles_count = 1;
  const auto check = [&](auto&& distance, double bias, double rms) {
    Noise noise(7);
    const Grid<float> volume = sampled(
        l, [&](Vec3 x) { return 20 - 12 * std::erf(distance(x) / (std::sqrt(2.0) * 0.6)) + 8 * noise.gaussian(); });
    Report report;
    const Evolved r = run(presegment(volume, {}, window, report), p);
    const Deviation d = deviation(r.field, [&](Vec3 x) { return -distance(x); });
    EXPECT_LT(std::abs(d.mean), bias);
    EXPECT_LT(d.rms, rms);
    EXPECT_LT(d.max, 1.8) << "no piece elsewhere";
  };
  check(ellipsoid, 0.25, 0.3);
  check(capsule, 0.3, 0.35);
}

TEST(Snake, AGeodesicSnakeRestsWhereItsForcesBalance) {
  const double radius = 11, sigma = 0.7;
  const Lattice l = lattice({32, 32, 32}, {0.5, 0.5, 0.7});
  const Grid<float> volume =
      sampled(l, [&](Vec3 p) { return 100 * std::erf((radius - norm(p - centre)) / (std::sqrt(2.0) * sigma)); });
  // With ITK-SNAP's kappa the surface stops where the gradient begins to rise; with a steeper one, at the edge.
  for (const double kappa : {2.6, 45.0}) {
    PresegmentParams edges;
    edges.method = PresegmentMethod::edges;
    edges.edge_kappa_hu_per_mm = kappa;
    Report report;
    const Field speed = presegment(volume, {}, edges, report);
    SnakeParams p;
    p.method = SnakeMethod::geodesic;
    const double s = std::hypot(sigma, edges.edge_sigma_mm);
    const auto g = [&](double r) {
      const double slope = 200 / (std::sqrt(2 * M_PI) * s) * std::exp(-std::pow((r - radius) / s, 2) / 2);
      return 1 / (1 + std::pow(slope / kappa, edges.edge_exponent));
    };
    double rest = 6;
    while (g(rest) - p.curvature * 2 / rest - p.advection * (g(rest + 1e-4) - g(rest - 1e-4)) / 2e-4 > 0) rest += 1e-3;
    for (const char* bubble : {"0,0,0,5", "1,0,0,7"}) {
      p.bubbles = bubble;
      const Evolved r = run(speed, p);
      const Deviation d = deviation(r.field, [&](Vec3 x) { return norm(x - centre) - rest; });
      EXPECT_LT(std::abs(d.mean), 0.15) << bubble << " " << kappa << " " << rest;
      EXPECT_LT(d.rms, 0.2) << bubble << " " << kappa;
    }
    if (kappa == 45) {
      EXPECT_NEAR(rest, radius, 0.5);
    }
  }
}

TEST(Snake, CoarseLevelsChangeTheWayNotTheResult) {
  const Field speed = ball_speed(lattice({44, 44, 44}, {0.5, 0.5, 0.8}), 17);
  SnakeParams p;
  p.bubbles = "0,0,0,5";
  p.coarse_levels_count = 0;
  const Field direct = run(speed, p).field;
  for (int levels : {1, 2, 4}) {
    p.coarse_levels_count = levels;
    EXPECT_GT(dice(run(speed, p).field, direct), 0.998) << levels;
  }
}

TEST(Snake, AStructureThinnerThanTheCoarseVoxelsIsKept) {
  const Lattice l = lattice({30, 20, 20}, {0.5, 0.5, 0.5});
  const auto rod = [](Vec3 p) { return 1.1 - norm(p - Vec3{std::clamp(p.x, -10.0, 10.0), 0, 0}); };
  const Field speed = sampled(l, [&](Vec3 p) { return std::clamp(3 * rod(p), -1.0, 1.0); });
  SnakeParams p;
  p.bubbles = "0,0,0,1";
  p.coarse_levels_count = 3;
  const Evolved r = run(speed, p);
  EXPECT_GT(dice(r.field, sampled(l, [&](Vec3 x) { return rod(x); })), 0.8);
}

TEST(Snake, StaysWithinAndWithoutToAFractionOfAVoxel) {
  const Lattice l = lattice({40, 40, 40}, {0.6, 0.6, 0.6});
  const Field speed = ball_speed(l, 16);
  const Field within = sampled(l, [](Vec3 p) { return 1000 * (7.3 - std::abs(p.x)); });
  const Field without = sampled(l, [](Vec3 p) { return p.y - 5.2; });
  SnakeParams p;
  p.bubbles = "0,0,0,4";
  const Evolved r = run(speed, p, {nullptr, &within, &without});
  double most_x = 0, most_y = -100;
  deviation(r.field, [&](Vec3 x) {
    most_x = std::max(most_x, std::abs(x.x));
    most_y = std::max(most_y, x.y);
    return 0;
  });
  EXPECT_NEAR(most_x, 7.3, 0.1);
  EXPECT_NEAR(most_y, 5.2, 0.1);
}

TEST(Snake, BubblesArePlacedWhereThereIsRoom) {
  const Lattice l = lattice({80, 40, 40}, {0.5, 0.5, 1});
  const auto two = [](Vec3 p) { return std::max(9 - norm(p - Vec3{-18, 0, 0}), 6 - norm(p - Vec3{20, 3, 0})); };
  const Field speed = sampled(l, [&](Vec3 p) { return soft(two(p)); });
  const std::vector<Bubble> bubbles = place_bubbles(speed, 2, 3);
  ASSERT_EQ(bubbles.size(), 2u);
  EXPECT_LT(norm(bubbles[0].centre_mm - Vec3{-18, 0, 0}), 1.5);
  EXPECT_NEAR(bubbles[0].radius_mm, 8.1, 0.8);
  EXPECT_LT(norm(bubbles[1].centre_mm - Vec3{20, 3, 0}), 1.5);
  SnakeParams p;
  p.bubbles_count = 2;
  const Evolved both = run(speed, p);
  const Deviation d = deviation(both.field, [&](Vec3 x) { return -two(x); });
  EXPECT_LT(std::abs(d.mean), 0.1);
  // Where they were placed can be given again; the balls do not touch.
  const auto again = parse_bubbles(std::get<std::string>(*both.report.find("bubbles")));
  ASSERT_EQ(again.size(), 2u);
  EXPECT_LT(norm(again[1].centre_mm - bubbles[1].centre_mm), 0.1);
  EXPECT_EQ(to_text(*both.report.find("pieces_count")), "2");
  const Error e = error_of([&] { place_bubbles(speed, 2, 12); });
  EXPECT_EQ(e.code(), ExitCode::quality);
  EXPECT_EQ(e.field(), "bubble_min_radius_mm");
}

TEST(Snake, BubblesAreReadStrictly) {
  const auto two = parse_bubbles("1,2,3,4; -1.5, 0 ,2e1,0.5");
  ASSERT_EQ(two.size(), 2u);
  EXPECT_EQ(two[1].centre_mm, (Vec3{-1.5, 0, 20}));
  EXPECT_EQ(two[1].radius_mm, 0.5);
  for (const char* bad : {"", ";", "1,2,3", "1,2,3,4,5", "1,2,3,0", "1,2,3,-4", "1,2,3,nan", "1,2,3,4;", "1 2 3 4",
                          "1,2,3,0x4", "1e7,0,0,1", "a,b,c,d"})
    EXPECT_EQ(error_of([&] { parse_bubbles(bad); }).code(), ExitCode::usage) << bad;
}

TEST(Snake, NothingToBeginWithIsRefused) {
  const Lattice l = lattice({20, 20, 20}, {1, 1, 1});
  const Field speed = ball_speed(l, 6);
  Report report;
  const auto refused = [&](const SnakeParams& p, const SnakeMasks& masks = {}) {
    return error_of([&] { snake(speed, masks, p, report); });
  };
  SnakeParams p;
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
  const Field nothing(l, -1.f);
  EXPECT_EQ(refused(p, {&nothing, nullptr, nullptr}).code(), ExitCode::quality);
  EXPECT_EQ(refused(p, {&speed, &nothing, nullptr}).code(), ExitCode::quality);
  p.propagation = p.curvature = 0;
  EXPECT_EQ(refused(p, {&speed, nullptr, nullptr}).code(), ExitCode::usage);
}

TEST(Snake, ALeakIsRefusedByItsVolumeAndWarnedOfAtTheEdge) {
  // A ball with a hole in its wall into a slab that leaves the volume.
  const Lattice l = lattice({50, 30, 30}, {0.7, 0.7, 0.7});
  const Field speed = sampled(l, [](Vec3 p) {
    const double in = 8 - norm(p + Vec3{10, 0, 0});
    const double hole = 2 - norm(Vec3{0, p.y, p.z});
    return soft(std::max({in, p.x > -10 ? hole : -9.0, p.x - 5}));
  });
  SnakeParams p;
  p.bubbles = "-10,0,0,5";
  const Evolved leaked = run(speed, p);
  ASSERT_FALSE(leaked.report.warnings.empty());
  EXPECT_NE(leaked.report.warnings[0].find("edge"), std::string::npos);
  p.max_volume_ml = 4;
  Report report;
  const Error e = error_of([&] { snake(speed, {}, p, report); });
  EXPECT_EQ(e.code(), ExitCode::quality);
  EXPECT_EQ(e.field(), "max_volume_ml");
}

TEST(Snake, AGeodesicSnakeStaysWithinThePresegmentationsMask) {
  // No edge anywhere: what holds the surface is the speed's -1 outside of presegment's `within` alone.
  const Lattice l = lattice({40, 40, 40}, {0.9, 0.9, 2});
  Noise noise(11);
  const Grid<float> volume = sampled(l, [&](Vec3) { return 30 + noise.gaussian(); });
  const Field within = sampled(l, [](Vec3 p) { return 13 - norm(p - centre); });
  PresegmentParams edges;
  edges.method = PresegmentMethod::edges;
  edges.edge_kappa_hu_per_mm = 5;
  Report report;
  const Field speed = presegment(volume, {&within, nullptr}, edges, report);
  SnakeParams p;
  p.method = SnakeMethod::geodesic;
  p.bubbles = "0,0,0,6";
  const Evolved r = run(speed, p);
  const Field mask = fit(within, static_cast<const Lattice&>(r.field), -1.f);
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
  const Lattice l = lattice({60, 50, 50}, {0.8, 0.8, 0.8});
  Noise noise(9);
  const Grid<float> volume = sampled(l, [&](Vec3 p) { return (norm(p) < 9 ? 0.0 : 20.0) + 12 * noise.gaussian(); });
  const Field within = sampled(l, [](Vec3 p) { return 20 - norm(p); });
  const auto evolved = [&](double upper_hu, double sigma_mm) {
    PresegmentParams window;
    window.lower_hu = -40;
    window.upper_hu = upper_hu;
    window.smoothing_sigma_mm = sigma_mm;
    Report report;
    SnakeParams p;
    p.bubbles = "0,0,0,5";
    return run(presegment(volume, {&within, nullptr}, window, report), p, {nullptr, &within, nullptr});
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
  const Field all(l, 0.8f);
  SnakeParams p;
  p.bubbles = "0,0,0,5";
  const Evolved held = run(all, p, {nullptr, &within, nullptr});
  EXPECT_GT(figure(held, "held_by_limits_ratio"), 0.9);
  EXPECT_TRUE(warned(held, "rest on the limits"));
}

TEST(Snake, IterationsAreThoseOfAllResolutionsTogether) {
  const Field speed = ball_speed(lattice({44, 44, 44}, {0.5, 0.5, 0.8}), 17);
  SnakeParams p;
  p.bubbles = "0,0,0,5";
  p.min_change_mm = 0;
  for (const int levels : {0, 1, 3})
    for (const int most : {0, 1, 50}) {
      p.coarse_levels_count = levels;
      p.max_iterations_count = most;
      const Evolved r = run(speed, p);
      EXPECT_EQ(std::get<std::int64_t>(*r.report.find("iterations_count")), most) << levels;
      if (most == 0) {
        ASSERT_EQ(r.report.warnings.size(), 1u);
        EXPECT_NE(r.report.warnings[0].find("max_iterations_count is 0"), std::string::npos);
      }
    }
}

TEST(Snake, WhatVanishesFillsAllOrLosesItsStructureIsRefused) {
  const Lattice l = lattice({20, 20, 20}, {0.8, 0.8, 0.8});
  const Field start = sampled(l, [](Vec3 p) { return 5 - norm(p); });
  Report report;
  SnakeParams p;
  p.max_iterations_count = 1000;
  const auto refused = [&](const Field& speed) { return error_of([&] { evolve_snake(speed, start, p, report); }); };
  EXPECT_EQ(refused(Field(l, -1.f)).field(), "start");
  EXPECT_EQ(refused(Field(l, 1.f)).field(), "speed");
  EXPECT_EQ(refused(Field(l, 1.f)).code(), ExitCode::quality);
  p.min_mean_speed = 0.5;
  p.max_iterations_count = 1;
  EXPECT_EQ(refused(Field(l, 0.1f)).field(), "min_mean_speed");
}

TEST(Snake, NoNumberNoHuAndNoOtherRasterGetIn) {
  const Lattice l = lattice({20, 20, 20}, {1, 1, 1});
  const Field good = ball_speed(l, 6);
  Report report;
  const auto code = [&](const Field& speed, const Field& start) {
    return error_of([&] { evolve_snake(speed, start, {}, report); }).code();
  };
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), 40.f}) {
    Field speed = good;
    speed.at(3, 4, 5) = bad;
    EXPECT_EQ(code(speed, good), ExitCode::bad_input) << bad;
    if (bad != 40.f) {
      EXPECT_EQ(code(good, speed), ExitCode::bad_input) << bad;
    }
  }
  Field other = good;
  other.spacing_mm.x = 1.1;
  EXPECT_EQ(code(good, other), ExitCode::bad_input);
}

TEST(Snake, ManyIterationsStayBoundedWhateverTheSpeed) {
  const Lattice l = lattice({10, 10, 10}, {0.5, 0.5, 1.7});
  Noise noise(3);
  const Field rough =
      sampled(l, [&](Vec3 p) { return std::clamp(0.7 * soft(4 - norm(p)) + 0.6 * noise.gaussian(), -1.0, 1.0); });
  SnakeParams p;
  p.max_iterations_count = 10000;
  p.min_change_mm = 0;
  p.coarse_levels_count = 0;
  p.bubbles = "0,0,0,3";
  for (const double curvature : {0.2, 10.0})
    for (const SnakeMethod method : {SnakeMethod::region_competition, SnakeMethod::geodesic}) {
      p.curvature = curvature;
      p.method = method;
      Report report;
      const Error e = error_of([&] {
        const Field f = snake(rough, {}, p, report);
        for (const float v : f.voxels) ASSERT_LE(std::abs(v), 6.0f);
      });
      EXPECT_TRUE(e.code() == ExitCode::ok || e.code() == ExitCode::quality) << e.what();
      if (curvature == 0.2 && method == SnakeMethod::region_competition) {
        EXPECT_EQ(e.code(), ExitCode::ok) << e.what();
      }
    }
}

TEST(Snake, TheSameBytesWithOneTwoAndEightThreads) {
  const Lattice l = lattice({40, 36, 32}, {0.6, 0.6, 1.1});
  Noise noise(5);
  const Grid<float> volume =
      sampled(l, [&](Vec3 p) { return 20 + 20 * soft(12 - norm(p - centre)) + 15 * noise.gaussian(); });
  std::vector<Field> fields;
  for (const int threads : {1, 2, 8}) {
    set_thread_count(threads);
    for (const PresegmentMethod method :
         {PresegmentMethod::regions, PresegmentMethod::edges, PresegmentMethod::classes}) {
      PresegmentParams w;
      w.method = method;
      w.lower_hu = 20;
      w.upper_hu = 90;
      w.smoothing_sigma_mm = 0.7;
      w.classes_count = 2;
      w.first_class = w.last_class = 2;
      Report report;
      SnakeParams p;
      p.bubbles_count = 3;
      p.max_iterations_count = 60;
      if (method == PresegmentMethod::edges) {
        p.method = SnakeMethod::geodesic;
        p.bubbles_count = 0;
        p.bubbles = "0,0,0,6";
      }
      fields.push_back(snake(presegment(volume, {}, w, report), {}, p, report));
    }
  }
  set_thread_count(0);
  for (std::size_t i = 3; i < fields.size(); ++i) EXPECT_TRUE(fields[i] == fields[i % 3]) << i;
}

}  // namespace
}  // namespace trephine
