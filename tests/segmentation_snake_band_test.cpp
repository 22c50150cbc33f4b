// SPDX-License-Identifier: GPL-3.0-or-later
// The solver at one resolution against closed forms: fronts at a given speed, curvature flow, rest at the zero of g.
#include <gtest/gtest.h>

#include "segmentation/snake_band.h"
#include "segmentation_snake_shapes.h"

namespace trephine {
namespace {

using namespace segmentation_test;
using segmentation::BandEnd;
using segmentation::BandParams;
using segmentation::BandRun;
using segmentation::evolve_band;

constexpr Vec3 centre{0.13, -0.21, 0.17};
grid::Grid<float> ball(const grid::Lattice& l, double radius) {
  return sampled(l, [&](Vec3 p) { return radius - norm(p - centre); });
}

TEST(SnakeBand, TheStartBecomesADistanceAndStaysInPlace) {
  const grid::Lattice l = lattice({30, 30, 30}, {0.7, 0.7, 1.2});
  grid::Grid<float> phi = sampled(l, [](Vec3 p) { return 40 * (100 - dot(p, p)); });  // no distance at all
  BandParams none;
  none.max_iterations_count = 0;
  const BandRun run = evolve_band(phi, phi, none, {});
  EXPECT_EQ(run.iterations, 0);
  const FieldDeviation d = field_deviation(phi, [](Vec3 p) { return norm(p) - 10; });
  EXPECT_LT(d.max, 0.06);
  double worst = 0;
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i) {
        const double truth = 10 - norm(l.to_world_mm({double(i), double(j), double(k)}));
        const double f = phi.at(i, j, k);
        EXPECT_NE(f, 0);
        EXPECT_EQ(f > 0, truth > 0);
        if (std::abs(truth) < 0.7) worst = std::max(worst, std::abs(f - truth));
      }
  EXPECT_LT(worst, 0.1);
}

TEST(SnakeBand, AFrontMovesAtItsSpeed) {
  for (const Vec3 spacing : {Vec3{0.5, 0.5, 0.5}, Vec3{0.4, 0.4, 1.2}})
    for (const double speed : {1.0, 0.4, -0.7}) {
      const grid::Lattice l = lattice({32, 32, 32}, spacing);
      grid::Grid<float> phi = ball(l, 8);
      const grid::Grid<float> g(l, float(speed));
      BandParams p;
      p.max_iterations_count = 24;
      const BandRun run = evolve_band(g, phi, p, {});
      const double radius = 8 + speed * run.time;
      const FieldDeviation d = field_deviation(phi, [&](Vec3 x) { return norm(x - centre) - radius; });
      // First order upwind: some per cent of the way, less on the way out.
      EXPECT_LT(std::abs(d.mean), (speed > 0 ? 0.025 : 0.06) * std::abs(speed) * run.time) << speed << " " << spacing.z;
      EXPECT_LT(d.max, 0.4 * spacing.z) << speed;
    }
}

TEST(SnakeBand, CurvatureFlowFollowsTheLawOfABall) {
  // r(t)^2 = r0^2 - 4 c t, down to 60 % of the radius.
  struct Case {
    Vec3 spacing;
    double share;  ///< of the way
  };
  for (const Case& c :
       {Case{{0.5, 0.5, 0.5}, 0.02}, Case{{1, 1, 1}, 0.02}, Case{{0.4, 0.4, 0.6}, 0.06}, Case{{0.4, 0.4, 1.0}, 0.2}})
    for (const double weight : {0.2, 1.0}) {
      const grid::Lattice l = lattice({26, 26, 26}, c.spacing);
      BandParams p;
      p.propagation = 0;
      p.curvature = weight;
      p.max_iterations_count = 1;
      grid::Grid<float> phi = ball(l, 9);
      const double dt = evolve_band(phi, phi, p, {}).time_step;
      p.max_iterations_count = int((81 - 29.16) / (4 * weight) / dt);
      phi = ball(l, 9);
      const BandRun run = evolve_band(phi, phi, p, {});
      const double radius = std::sqrt(81 - 4 * weight * run.time);
      const FieldDeviation d = field_deviation(phi, [&](Vec3 x) { return norm(x - centre) - radius; });
      EXPECT_LT(std::abs(d.mean), c.share * (9 - radius)) << c.spacing.z << " " << weight;
    }
}

TEST(SnakeBand, SaysHowItEnded) {
  const grid::Lattice l = lattice({16, 16, 16}, {0.5, 0.5, 0.5});
  const auto ended = [&](float speed, double min_change, std::size_t most) {
    grid::Grid<float> phi = ball(l, 5), g(l, speed);
    BandParams p;
    p.max_iterations_count = 100;
    p.min_change_mm = min_change;
    p.max_voxels = most;
    return evolve_band(g, phi, p, {}).end;
  };
  const std::size_t any = ~std::size_t{0};
  EXPECT_EQ(ended(-1, 0.001, any), BandEnd::vanished);
  EXPECT_EQ(ended(1, 0.001, any), BandEnd::filled);
  EXPECT_EQ(ended(1, 0.001, 5000), BandEnd::too_large);
  EXPECT_EQ(ended(0.01f, 0, any), BandEnd::iterations);
  EXPECT_EQ(ended(0.01f, 0.01, any), BandEnd::converged);
}

}  // namespace
}  // namespace trephine
