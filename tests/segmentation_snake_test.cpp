// SPDX-License-Identifier: GPL-3.0-or-later
// evolve_snake and snake: where the surface comes to rest against closed forms, extremes, the same bytes by threads.
#include "segmentation/snake.h"

#include <gtest/gtest.h>

#include "base/parallel.h"
#include "segmentation/bubbles.h"
#include "segmentation/speed_image.h"
#include "segmentation_snake_evolved.h"

namespace trephine {
namespace {

using namespace segmentation_test;

TEST(Snake, ABubbleGrowsToTheEdgeOfABall) {
  const double radius = 14;
  for (const Vec3 spacing : {Vec3{0.5, 0.5, 0.5}, Vec3{0.7, 0.7, 1.5}, Vec3{0.3, 0.3, 5}}) {
    segmentation::SnakeParams p;
    p.bubbles = "3,2,1,6";
    p.curvature = 0;
    const Evolved r = run(ball_speed(lattice({40, 40, 50}, spacing), radius), p);
    EXPECT_EQ(stopped_by(r), "converged");
    const FieldDeviation d = field_deviation(r.field, [&](Vec3 x) { return norm(x - centre) - radius; });
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
  segmentation::SnakeParams p;
  p.bubbles = "0,0,0,7";
  p.curvature = weight;
  p.min_change_mm = 0.0002;
  const Evolved r = run(ball_speed(lattice({26, 26, 26}, {0.5, 0.5, 0.5}), radius), p);
  const FieldDeviation d = field_deviation(r.field, [&](Vec3 x) { return norm(x - centre) - rest; });
  EXPECT_LT(std::abs(d.mean), 0.02) << rest;
  EXPECT_LT(d.max, 0.06);
}

TEST(Snake, NoiseAndBlurLeaveAnEllipsoidAndACapsuleWithinAFractionOfAVoxel) {
  // HU of CSF 8 in tissue 32, noise of 8 HU at 0.6 mm; a window, and its snake with ITK-SNAP's weights.
  const grid::Lattice l = lattice({50, 40, 40}, {0.6, 0.6, 0.9});
  const Vec3 a{15, 9, 8};
  const auto ellipsoid = [&](Vec3 p) {
    const Vec3 q{p.x / a.x, p.y / a.y, p.z / a.z}, g{q.x / a.x, q.y / a.y, q.z / a.z};
    return norm(q) > 0 ? norm(q) * (1 - norm(q)) / norm(g) : a.z;  // distance to first order
  };
  const auto capsule = [&](Vec3 p) { return 6 - norm(p - Vec3{std::clamp(p.x, -12.0, 12.0), 0, 0}); };
  segmentation::PresegmentParams window;
  window.lower_hu = -30;
  window.upper_hu = 20;
  window.smoothing_sigma_mm = 0.8;
  segmentation::SnakeParams p;
  p.bubbles_count = 1;
  const auto check = [&](auto&& distance, double bias, double rms) {
    Noise noise(7);
    const grid::Grid<float> volume = sampled(
        l, [&](Vec3 x) { return 20 - 12 * std::erf(distance(x) / (std::sqrt(2.0) * 0.6)) + 8 * noise.gaussian(); });
    const Evolved r = run(segmentation::presegment(volume, {}, window).value, p);
    const FieldDeviation d = field_deviation(r.field, [&](Vec3 x) { return -distance(x); });
    EXPECT_LT(std::abs(d.mean), bias);
    EXPECT_LT(d.rms, rms);
    EXPECT_LT(d.max, 1.8) << "no piece elsewhere";
  };
  check(ellipsoid, 0.25, 0.3);
  check(capsule, 0.3, 0.35);
}

TEST(Snake, AGeodesicSnakeRestsWhereItsForcesBalance) {
  const double radius = 11, sigma = 0.7;
  const grid::Lattice l = lattice({32, 32, 32}, {0.5, 0.5, 0.7});
  const grid::Grid<float> volume =
      sampled(l, [&](Vec3 p) { return 100 * std::erf((radius - norm(p - centre)) / (std::sqrt(2.0) * sigma)); });
  // With ITK-SNAP's kappa the surface stops where the gradient begins to rise; with a steeper one, at the edge.
  for (const double kappa : {2.6, 45.0}) {
    segmentation::PresegmentParams edges;
    edges.method = segmentation::PresegmentMethod::edges;
    edges.edge_kappa_hu_per_mm = kappa;
    const grid::Field speed = segmentation::presegment(volume, {}, edges).value;
    segmentation::SnakeParams p;
    p.method = segmentation::SnakeMethod::geodesic;
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
      const FieldDeviation d = field_deviation(r.field, [&](Vec3 x) { return norm(x - centre) - rest; });
      EXPECT_LT(std::abs(d.mean), 0.15) << bubble << " " << kappa << " " << rest;
      EXPECT_LT(d.rms, 0.2) << bubble << " " << kappa;
    }
    if (kappa == 45) {
      EXPECT_NEAR(rest, radius, 0.5);
    }
  }
}

TEST(Snake, CoarseLevelsChangeTheWayNotTheResult) {
  const grid::Field speed = ball_speed(lattice({44, 44, 44}, {0.5, 0.5, 0.8}), 17);
  segmentation::SnakeParams p;
  p.bubbles = "0,0,0,5";
  p.coarse_levels_count = 0;
  const grid::Field direct = run(speed, p).field;
  for (int levels : {1, 2, 4}) {
    p.coarse_levels_count = levels;
    EXPECT_GT(dice(run(speed, p).field, direct), 0.998) << levels;
  }
}

TEST(Snake, AStructureThinnerThanTheCoarseVoxelsIsKept) {
  const grid::Lattice l = lattice({30, 20, 20}, {0.5, 0.5, 0.5});
  const auto rod = [](Vec3 p) { return 1.1 - norm(p - Vec3{std::clamp(p.x, -10.0, 10.0), 0, 0}); };
  const grid::Field speed = sampled(l, [&](Vec3 p) { return std::clamp(3 * rod(p), -1.0, 1.0); });
  segmentation::SnakeParams p;
  p.bubbles = "0,0,0,1";
  p.coarse_levels_count = 3;
  const Evolved r = run(speed, p);
  EXPECT_GT(dice(r.field, sampled(l, [&](Vec3 x) { return rod(x); })), 0.8);
}

TEST(Snake, StaysWithinAndWithoutToAFractionOfAVoxel) {
  const grid::Lattice l = lattice({40, 40, 40}, {0.6, 0.6, 0.6});
  const grid::Field speed = ball_speed(l, 16);
  const grid::Field within = sampled(l, [](Vec3 p) { return 1000 * (7.3 - std::abs(p.x)); });
  const grid::Field without = sampled(l, [](Vec3 p) { return p.y - 5.2; });
  segmentation::SnakeParams p;
  p.bubbles = "0,0,0,4";
  const Evolved r = run(speed, p, {nullptr, &within, &without});
  double max_x = 0, max_y = -100;
  field_deviation(r.field, [&](Vec3 x) {
    max_x = std::max(max_x, std::abs(x.x));
    max_y = std::max(max_y, x.y);
    return 0;
  });
  EXPECT_NEAR(max_x, 7.3, 0.1);
  EXPECT_NEAR(max_y, 5.2, 0.1);
}

TEST(Snake, BubblesArePlacedWhereThereIsRoom) {
  const grid::Lattice l = lattice({80, 40, 40}, {0.5, 0.5, 1});
  const auto two = [](Vec3 p) { return std::max(9 - norm(p - Vec3{-18, 0, 0}), 6 - norm(p - Vec3{20, 3, 0})); };
  const grid::Field speed = sampled(l, [&](Vec3 p) { return soft(two(p)); });
  const std::vector<segmentation::Bubble> bubbles = segmentation::place_bubbles(speed, 2, 3);
  ASSERT_EQ(bubbles.size(), 2u);
  EXPECT_LT(norm(bubbles[0].centre_mm - Vec3{-18, 0, 0}), 1.5);
  EXPECT_NEAR(bubbles[0].radius_mm, 8.1, 0.8);
  EXPECT_LT(norm(bubbles[1].centre_mm - Vec3{20, 3, 0}), 1.5);
  segmentation::SnakeParams p;
  p.bubbles_count = 2;
  const Evolved both = run(speed, p);
  const FieldDeviation d = field_deviation(both.field, [&](Vec3 x) { return -two(x); });
  EXPECT_LT(std::abs(d.mean), 0.1);
  // Where they were placed can be given again; the balls do not touch.
  const auto again = segmentation::parse_bubbles(std::get<std::string>(*both.report.find("bubbles")));
  ASSERT_EQ(again.size(), 2u);
  EXPECT_LT(norm(again[1].centre_mm - bubbles[1].centre_mm), 0.1);
  EXPECT_EQ(to_text(*both.report.find("pieces_count")), "2");
  const Error e = error_of([&] { segmentation::place_bubbles(speed, 2, 12); });
  EXPECT_EQ(e.code(), ExitCode::quality);
  EXPECT_EQ(e.field(), "bubble_min_radius_mm");
}

TEST(Snake, IterationsAreThoseOfAllResolutionsTogether) {
  const grid::Field speed = ball_speed(lattice({44, 44, 44}, {0.5, 0.5, 0.8}), 17);
  segmentation::SnakeParams p;
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

TEST(Snake, ManyIterationsStayBoundedWhateverTheSpeed) {
  const grid::Lattice l = lattice({10, 10, 10}, {0.5, 0.5, 1.7});
  Noise noise(3);
  const grid::Field rough =
      sampled(l, [&](Vec3 p) { return std::clamp(0.7 * soft(4 - norm(p)) + 0.6 * noise.gaussian(), -1.0, 1.0); });
  segmentation::SnakeParams p;
  p.max_iterations_count = 10000;
  p.min_change_mm = 0;
  p.coarse_levels_count = 0;
  p.bubbles = "0,0,0,3";
  for (const double curvature : {0.2, 10.0})
    for (const segmentation::SnakeMethod method :
         {segmentation::SnakeMethod::region_competition, segmentation::SnakeMethod::geodesic}) {
      p.curvature = curvature;
      p.method = method;
      const Error e = error_of([&] {
        const grid::Field f = segmentation::snake(rough, {}, p).value;
        for (const float v : f.voxels) ASSERT_LE(std::abs(v), 6.0f);
      });
      EXPECT_TRUE(e.code() == ExitCode::ok || e.code() == ExitCode::quality) << e.what();
      if (curvature == 0.2 && method == segmentation::SnakeMethod::region_competition) {
        EXPECT_EQ(e.code(), ExitCode::ok) << e.what();
      }
    }
}

TEST(Snake, TheSameBytesWithOneTwoAndEightThreads) {
  const grid::Lattice l = lattice({40, 36, 32}, {0.6, 0.6, 1.1});
  Noise noise(5);
  const grid::Grid<float> volume =
      sampled(l, [&](Vec3 p) { return 20 + 20 * soft(12 - norm(p - centre)) + 15 * noise.gaussian(); });
  std::vector<grid::Field> fields;
  for (const int threads : {1, 2, 8}) {
    set_thread_count(threads);
    for (const segmentation::PresegmentMethod method :
         {segmentation::PresegmentMethod::regions, segmentation::PresegmentMethod::edges,
          segmentation::PresegmentMethod::classes}) {
      segmentation::PresegmentParams w;
      w.method = method;
      w.lower_hu = 20;
      w.upper_hu = 90;
      w.smoothing_sigma_mm = 0.7;
      w.classes_count = 2;
      w.first_class = w.last_class = 2;
      segmentation::SnakeParams p;
      p.bubbles_count = 3;
      p.max_iterations_count = 60;
      if (method == segmentation::PresegmentMethod::edges) {
        p.method = segmentation::SnakeMethod::geodesic;
        p.bubbles_count = 0;
        p.bubbles = "0,0,0,6";
      }
      fields.push_back(segmentation::snake(segmentation::presegment(volume, {}, w).value, {}, p).value);
    }
  }
  set_thread_count(0);
  for (std::size_t i = 3; i < fields.size(); ++i) EXPECT_TRUE(fields[i] == fields[i % 3]) << i;
}

}  // namespace
}  // namespace trephine
