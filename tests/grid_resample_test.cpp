// SPDX-License-Identifier: GPL-3.0-or-later
// Voxels of another size: what they hold against what the old ones held, and where they lie.
#include "grid/resample.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "report_of.h"

namespace trephine {
namespace {

grid::Lattice oblique(std::array<int, 3> size, Vec3 spacing_mm) {
  grid::Lattice l;
  l.size = size;
  l.spacing_mm = spacing_mm;
  l.origin_mm = {-31, 7, 1200};
  const double c = std::cos(0.3), s = std::sin(0.3);
  l.direction.column = {Vec3{c, s, 0}, Vec3{-s, c, 0}, Vec3{0, 0, 1}};
  return l;
}

template <class F>
grid::HuVolume volume(const grid::Lattice& lattice, F hu_at) {
  grid::Grid<float> g(lattice);
  for (int k = 0; k < g.size[2]; ++k)
    for (int j = 0; j < g.size[1]; ++j)
      for (int i = 0; i < g.size[0]; ++i)
        g.at(i, j, k) = static_cast<float>(hu_at(g.to_world_mm({1. * i, 1. * j, 1. * k})));
  return g;
}

grid::HuVolume resampled(const grid::HuVolume& v, std::array<double, 3> spacing_mm) {
  grid::ResampleParams params;
  params.spacing_mm = spacing_mm;
  Report report;
  return value_of(report, grid::resample(v, params));
}

TEST(Resample, AZeroOrTheSameSpacingChangesNothing) {
  const grid::HuVolume v = volume(oblique({9, 7, 5}, {0.5, 0.6, 1.5}), [](Vec3 p) { return p.x * 3 - p.z; });
  EXPECT_EQ(std::get<grid::Grid<float>>(resampled(v, {0, 0, 0})), std::get<grid::Grid<float>>(v));
  EXPECT_EQ(std::get<grid::Grid<float>>(resampled(v, {0.5, 0, 1.5})), std::get<grid::Grid<float>>(v));
}

TEST(Resample, TheMiddleStaysAndTheExtentIsFilled) {
  const grid::Lattice old = oblique({100, 90, 41}, {0.47, 0.47, 2.0});
  const grid::HuVolume coarse = resampled(volume(old, [](Vec3) { return 7.0; }), {1, 1.5, 1});
  const grid::Lattice& made = grid::lattice_of(coarse);
  EXPECT_EQ(made.size, (std::array<int, 3>{47, 28, 82}));
  const auto middle = [](const grid::Lattice& l) {
    return l.to_world_mm({(l.size[0] - 1) / 2.0, (l.size[1] - 1) / 2.0, (l.size[2] - 1) / 2.0});
  };
  EXPECT_LT(norm(middle(made) - middle(old)), 1e-9);
  for (const float hu : std::get<grid::Grid<float>>(coarse).voxels) EXPECT_FLOAT_EQ(hu, 7);
}

TEST(Resample, ARampIsARampOnTheNewVoxelsToo) {
  const grid::Lattice old = oblique({60, 50, 40}, {0.5, 0.7, 1.3});
  const auto ramp = [](Vec3 p) { return 2 * p.x - 3 * p.y + 0.5 * (p.z - 1200); };
  for (const std::array<double, 3> spacing : {std::array<double, 3>{1.1, 1.7, 3.1}, {0.3, 0.4, 0.9}, {0.5, 1.9, 0.6}}) {
    const auto made = std::get<grid::Grid<float>>(resampled(volume(old, ramp), spacing));
    double worst = 0;
    // Away from the ends, where the outermost voxel goes on.
    for (int k = 4; k < made.size[2] - 4; ++k)
      for (int j = 4; j < made.size[1] - 4; ++j)
        for (int i = 4; i < made.size[0] - 4; ++i)
          worst = std::max(worst, std::abs(made.at(i, j, k) - ramp(made.to_world_mm({1. * i, 1. * j, 1. * k}))));
    EXPECT_LT(worst, 1e-3);
  }
}

TEST(Resample, WholeVoxelsJoinedAreTheirMeanAndIntegersAreRounded) {
  grid::Grid<std::int16_t> fine(oblique({4, 2, 2}, {1, 1, 1}));
  for (std::size_t n = 0; n < fine.voxels.size(); ++n) fine.voxels[n] = static_cast<std::int16_t>(n * n);
  const auto coarse = std::get<grid::Grid<std::int16_t>>(resampled(fine, {2, 2, 2}));
  ASSERT_EQ(coarse.size, (std::array<int, 3>{2, 1, 1}));
  for (int i = 0; i < 2; ++i) {
    double sum = 0;
    for (int k = 0; k < 2; ++k)
      for (int j = 0; j < 2; ++j)
        for (int di = 0; di < 2; ++di) sum += fine.at(2 * i + di, j, k);
    EXPECT_EQ(coarse.at(i, 0, 0), std::lround(sum / 8));
  }
}

TEST(Resample, TheSameBytesWithAnyThreadCountAndTheMeanIsKept) {
  const grid::Lattice old = oblique({64, 64, 33}, {0.5, 0.5, 1});
  const grid::HuVolume v = volume(old, [](Vec3 p) { return 1000 * std::sin(p.x) * std::cos(p.y * 1.3) + p.z; });
  const auto mean = [](const grid::Grid<float>& g) {
    double sum = 0;
    for (const float f : g.voxels) sum += f;
    return sum / double(g.voxels.size());
  };
  set_thread_count(1);
  const auto one = std::get<grid::Grid<float>>(resampled(v, {2, 2, 3}));
  set_thread_count(8);
  EXPECT_EQ(one, std::get<grid::Grid<float>>(resampled(v, {2, 2, 3})));
  set_thread_count(0);
  EXPECT_NEAR(mean(one), mean(std::get<grid::Grid<float>>(v)), 1e-2);
}

TEST(Resample, OneVoxelAtLeastAndNoMoreThanMemoryHolds) {
  const grid::HuVolume v = volume(oblique({3, 3, 3}, {1, 1, 1}), [](Vec3) { return 5.0; });
  EXPECT_EQ(grid::lattice_of(resampled(v, {50, 50, 50})).count(), 1u);
  const grid::HuVolume large = volume(oblique({200, 200, 200}, {5, 5, 5}), [](Vec3) { return 5.0; });
  grid::ResampleParams params;
  params.spacing_mm = {1e-3, 1e-3, 1e-3};
  Report report;
  try {
    value_of(report, grid::resample(large, params));
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::quality);
    EXPECT_EQ(e.field(), "spacing_mm");
  }
}

}  // namespace
}  // namespace trephine
