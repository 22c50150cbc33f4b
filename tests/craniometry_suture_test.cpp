// SPDX-License-Identifier: GPL-3.0-or-later
// Where a suture of a ball of bone crosses the midline, also where it has grown together there.
#include "craniometry/coronal_suture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace trephine {
namespace {

constexpr double outer_mm = 82, inner_mm = 75;

/// A shell of bone with a cleft at y = slope x, which is seen from `from_mm` beside the midline on, in voxels of a
/// millimetre with noise. The front is at -y.
grid::HuVolume ball_with_suture(double slope, double from_mm, unsigned seed) {
  grid::Lattice l;
  l.size = {181, 181, 95};
  l.spacing_mm = {1, 1, 1};
  l.origin_mm = {-90, -90, -4};
  grid::Grid<std::int16_t> g(l, std::int16_t(-1000));
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, 60);
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i) {
        const Vec3 p = l.to_world_mm({double(i), double(j), double(k)});
        const double r = norm(p);
        if (r > outer_mm + 1) continue;
        double hu = 30;
        if (r > inner_mm) hu = 1000;
        if (r > inner_mm && std::abs(p.y - slope * p.x) < 0.9 && std::abs(p.x) >= from_mm) hu = 600;
        g.at(i, j, k) = std::int16_t(std::lround(hu * std::clamp(outer_mm + 0.5 - r, 0.0, 1.0) + noise(random)));
      }
  return g;
}

double error_mm(const grid::HuVolume& volume) {
  const craniometry::CalvariaFrame frame{{0, 0, 0}, {0, -1, 0}, {0, 0, 1}, {1, 0, 0}, {0, -outer_mm, 0}};
  const auto bone = [](Vec3 from, Vec3 way, double) -> std::optional<Vec3> {
    const double b = dot(from, way), c = dot(from, from) - outer_mm * outer_mm, d = b * b - c;
    if (d < 0) return {};
    return from + way * (-b - std::sqrt(d));
  };
  const auto found = craniometry::find_coronal_suture(volume, frame, bone);
  if (!found) return 1e9;
  EXPECT_GE(found->confidence, 0.5);
  return std::abs(found->bregma_mm.y);
}

TEST(CoronalSuture, CrossesTheMidlineWhereItIsSeen) {
  for (const double slope : {0.0, 0.15}) EXPECT_LT(error_mm(ball_with_suture(slope, 0, 1)), 1.0) << slope;
}

TEST(CoronalSuture, CrossesItWhereItsSeenPartsPointTo) {
  for (unsigned seed = 1; seed <= 4; ++seed)
    for (const double slope : {0.0, 0.15})
      EXPECT_LT(error_mm(ball_with_suture(slope, 9, seed)), 1.5) << slope << " seed " << seed;
}

}  // namespace
}  // namespace trephine
