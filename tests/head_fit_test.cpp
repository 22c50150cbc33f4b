// SPDX-License-Identifier: GPL-3.0-or-later
// The surface of fluid fitted to the scan: a thin tube and the ball that it leaves, in slices as thick as the tube's
// radius, against their analytic distance.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "head/ventricles_fit.h"

namespace trephine::segmentation {
namespace {

constexpr double ball_mm = 7, tube_mm = 2;

/// Positive inside.
double truth(Vec3 p) {
  const double along = std::clamp(p.x, 0.0, 25.0);
  return std::max(ball_mm - norm(p), tube_mm - norm(p - Vec3{along, 0.3 * along, 0.2 * along}));
}

struct Scene {
  grid::Grid<float> hu;
  mask::BitMask known;
  grid::Field start;  ///< 0.8 mm too thin
};

Scene scene(double noise_hu) {
  grid::Lattice l;
  l.size = {56, 44, 20};
  l.spacing_mm = {0.95, 0.95, 2};
  l.origin_mm = {-15, -18, -17};
  Scene s{grid::Grid<float>(l), mask::BitMask(l), grid::Field(l)};
  unsigned state = 11;
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i) {
        double share = 0;
        for (int c = 0; c < 8; ++c)
          for (int b = 0; b < 5; ++b)
            for (int a = 0; a < 5; ++a)
              share +=
                  std::clamp(
                      0.5 + truth(l.to_world_mm({i + a / 2.5 - 0.8, j + b / 2.5 - 0.8, k + c / 8.0 - 0.4375})) / 0.3,
                      0.0, 1.0) /
                  200;
        double noise = 0;  // of unit variance
        for (int n = 0; n < 12; ++n) {
          state = state * 1664525u + 1013904223u;
          noise += (state >> 8) / double(1u << 24) - 0.5;
        }
        s.hu.at(i, j, k) = float(31 - 23 * share + noise_hu * noise);
        s.known.set(i, j, k);
        s.start.at(i, j, k) = float(truth(l.to_world_mm({double(i), double(j), double(k)})) - 0.8);
      }
  return s;
}

/// Mean distance from the truth where the field crosses 0 along the axes, and the signed mean.
std::pair<double, double> off(const grid::Field& f) {
  double sum = 0, signed_sum = 0, n = 0;
  for (int k = 0; k < f.size[2]; ++k)
    for (int j = 0; j < f.size[1]; ++j)
      for (int i = 0; i + 1 < f.size[0]; ++i) {
        const double a = f.at(i, j, k), b = f.at(i + 1, j, k);
        if ((a > 0) == (b > 0)) continue;
        const double d = truth(f.to_world_mm({i + a / (a - b), double(j), double(k)}));
        sum += std::abs(d);
        signed_sum -= d;
        n += 1;
      }
  return {sum / n, signed_sum / n};
}

TEST(VentriclesFit, ThinAndThickAreNeitherShrunkNorWidenedInThickSlices) {
  const Scene s = scene(0);
  const auto [mean, bias] = off(head::fit_fluid(s.hu, s.known, s.start, 0));
  RecordProperty("mean_um", int(1000 * mean));
  EXPECT_LT(mean, 0.1);
  EXPECT_LT(std::abs(bias), 0.1);
}

TEST(VentriclesFit, NoiseOfHalfTheContrastLeavesATenthOfAVoxelOfBias) {
  const Scene s = scene(12);
  const double noise = 12 * std::sqrt(s.hu.voxel_volume_mm3());
  const auto [mean, bias] = off(head::fit_fluid(s.hu, s.known, s.start, noise));
  RecordProperty("mean_um", int(1000 * mean));
  EXPECT_LT(mean, 0.25);
  EXPECT_LT(std::abs(bias), 0.15);
}

/// Two balls of 7 mm joined by a passage of `passage_mm` and 7 mm of length.
double joined_balls(Vec3 p, double passage_mm) {
  const double balls = 7 - norm(Vec3{std::abs(p.x) - 10.5, p.y, p.z});
  return std::max(balls, std::abs(p.x) < 10.5 ? passage_mm - std::hypot(p.y, p.z) : -20.0);
}

TEST(VentriclesFit, ANarrowPassageStaysOpen) {
  grid::Lattice l;
  l.size = {46, 26, 26};
  l.spacing_mm = {0.95, 0.95, 1};
  l.origin_mm = {-21.4, -11.9, -12.5};
  grid::Grid<float> hu(l);
  mask::BitMask known(l), everywhere(l);
  grid::Field start(l);
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i) {
        const Vec3 p = l.to_world_mm({double(i), double(j), double(k)});
        hu.at(i, j, k) = float(31 - 23 * std::clamp(0.5 + joined_balls(p, 1.9), 0.0, 1.0));
        known.set(i, j, k);
        everywhere.set(i, j, k);
        start.at(i, j, k) = float(joined_balls(p, 0.9));  // as noise and blur leave it
      }
  const auto narrowest = [&](const mask::BitMask* necks) {
    const grid::Field fit = head::fit_fluid(hu, known, start, 10, necks);
    double least = 100;
    for (double x = -4; x <= 4; x += 0.5) {
      const Vec3 q = fit.to_index({x, 0, 0});
      least = std::min(least, double(fit.at(int(q.x + 0.5), int(q.y + 0.5), int(q.z + 0.5))));
    }
    return least;
  };
  EXPECT_GT(narrowest(&everywhere), 0.5);
  EXPECT_LT(narrowest(nullptr), 0);  // what smoothing alone makes of it
}

TEST(VentriclesFit, FluidThatIsNotThereIsLeftAlone) {
  Scene s = scene(0);
  for (float& d : s.start.voxels) d = -5;  // no voxel inside: nothing to measure the fluid in
  const grid::Field f = head::fit_fluid(s.hu, s.known, s.start, 0);
  for (const float v : f.voxels) ASSERT_LT(v, 0);
}

}  // namespace
}  // namespace trephine::segmentation
