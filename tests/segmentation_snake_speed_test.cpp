// SPDX-License-Identifier: GPL-3.0-or-later
// Presegmentation: the formulas, the mixture, what is refused.
#include <gtest/gtest.h>

#include <limits>

#include "report_of.h"
#include "segmentation/speed_image.h"
#include "segmentation/tissue_mixture.h"
#include "segmentation_snake_shapes.h"

namespace trephine {
namespace {

using namespace segmentation_test;
using segmentation::fit_mixture;
using segmentation::Histogram;
using segmentation::TissueMixture;

/// HU that rise along x from -200 by 2 a voxel.
grid::Grid<float> ramp() {
  return sampled(lattice({200, 6, 6}, {1, 1, 1}), [](Vec3 p) { return 2 * (p.x + 99.5) - 200; });
}

TEST(Presegment, RegionsFollowTheFormulaOfItkSnap) {
  const grid::HuVolume volume = ramp();
  segmentation::PresegmentParams p;  // 40 to 80, smoothness 3
  const grid::Field speed = segmentation::presegment(volume, {}, p).value;
  const double k = std::log((2 - 1e-3) / 1e-3) / 40;
  for (int i = 0; i < 200; ++i) {
    const double x = 2.0 * i - 200;
    EXPECT_NEAR(speed.at(i, 3, 3), std::tanh((x - 40) * k) + std::tanh((80 - x) * k) - 1, 1e-5) << x;
  }
  EXPECT_NEAR(speed.at(130, 3, 3), 1 - 2e-3, 1e-5) << "60 HU: halfway";
  EXPECT_NEAR(speed.at(120, 3, 3), 0, 2e-3) << "40 HU";

  p.sides = segmentation::PresegmentSides::lower;
  const double one = std::log((2 - 1e-3) / 1e-3) / (398.0 / 3);
  EXPECT_NEAR(segmentation::presegment(volume, {}, p).value.at(150, 3, 3), std::tanh((100 - 40) * one), 1e-5);
  p.sides = segmentation::PresegmentSides::upper;
  p.smooth_range_hu = 100;
  EXPECT_NEAR(segmentation::presegment(volume, {}, p).value.at(150, 3, 3), std::tanh((80 - 100) * k * 0.4), 1e-5);
}

TEST(Presegment, EdgesAreInMm) {
  // A blurred step of 100 HU across z; whatever the spacing, the same speed at the same place.
  for (const double step : {0.5, 1.0, 2.0}) {
    const grid::HuVolume volume = sampled(lattice({8, 8, 40}, {0.7, 0.7, step}),
                                          [](Vec3 p) { return 50 * std::erf((p.z - 0.3) / (std::sqrt(2.0) * 2)); });
    segmentation::PresegmentParams p;
    p.method = segmentation::PresegmentMethod::edges;
    p.edge_sigma_mm = 1.5;
    p.edge_kappa_hu_per_mm = 10;
    const grid::Field speed = segmentation::presegment(volume, {}, p).value;
    const double s = std::hypot(2.0, 1.5);
    for (int k = 4; k < speed.size[2] - 4; ++k) {
      const double z = speed.to_world_mm({0, 0, double(k)}).z - 0.3;
      const double slope = 100 / (std::sqrt(2 * M_PI) * s) * std::exp(-z * z / (2 * s * s));
      EXPECT_NEAR(speed.at(5, 5, k), 1 / (1 + std::pow(slope / 10, 3)), step > 1 ? 0.12 : 0.04) << step << " " << z;
      EXPECT_GE(speed.at(5, 5, k), 0);
    }
  }
}

TEST(Presegment, TheMixtureFindsItsClasses) {
  Histogram h;
  h.first = -60;
  h.counts.resize(200);
  const double truth[3][3] = {{8, 6, 0.2}, {30, 5, 0.5}, {45, 4, 0.3}};
  for (std::size_t b = 0; b < 200; ++b) {
    double n = 0;
    for (const auto& t : truth) {
      const double z = (h.first + double(b) - t[0]) / t[1];
      n += 1e6 * t[2] / t[1] * std::exp(-z * z / 2);
    }
    h.counts[b] = std::uint64_t(n);
  }
  const TissueMixture m = fit_mixture(h, 3);
  ASSERT_EQ(m.classes.size(), 3u);
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(m.classes[c].mean, truth[c][0], 0.3);
    EXPECT_NEAR(m.classes[c].sigma, truth[c][1], 0.3);
    EXPECT_NEAR(m.classes[c].weight, truth[c][2], 0.02);
  }
  EXPECT_GT(m.share(8, 0, 0), 0.99);
  EXPECT_GT(m.share(-5000, 0, 0), 0.99) << "nothing is darker than the darkest";
  EXPECT_LT(m.share(5000, 0, 1), 0.02);
  EXPECT_NEAR(m.share(20, 0, 2), 1, 1e-12);

  Histogram two;
  two.counts = {5, 0, 0, 9};
  EXPECT_EQ(error_of([&] { fit_mixture(two, 2); }).code(), ExitCode::quality);
}

TEST(Presegment, ClassesPartTissuesInNoise) {
  Noise noise(11);
  const grid::Lattice l = lattice({40, 40, 40}, {1, 1, 1});
  const auto shape = [](Vec3 p) { return 12 - norm(p); };
  const grid::HuVolume volume = sampled(l, [&](Vec3 p) { return (shape(p) > 0 ? 8 : 34) + 6 * noise.gaussian(); });
  const grid::Field all = sampled(l, [](Vec3 p) { return 15 - norm(p); });
  segmentation::PresegmentParams p;
  p.method = segmentation::PresegmentMethod::classes;
  p.classes_count = 2;
  p.smoothing_sigma_mm = 0.6;
  Report report;
  const grid::Field speed = value_of(report, segmentation::presegment(volume, {&all, nullptr}, p));
  EXPECT_GT(dice(speed, sampled(l, [&](Vec3 x) { return shape(x); })), 0.97);
  EXPECT_NEAR(std::get<double>(*report.find("class_1_hu")), 8, 2.5);
  EXPECT_NEAR(std::get<double>(*report.find("class_2_hu")), 34, 2.5);
  EXPECT_EQ(speed.at(0, 0, 0), -1) << "outside `within`";
  EXPECT_LT(speed.count(), l.count()) << "cropped to `within`";
}

TEST(Presegment, WhatTellsNothingIsRefused) {
  const grid::Lattice l = lattice({10, 10, 10}, {1, 1, 1});
  const auto refused = [&](const grid::Grid<float>& volume, const segmentation::PresegmentParams& p,
                           const segmentation::PresegmentMasks& masks = {}) {
    return error_of([&] { segmentation::presegment(volume, masks, p); });
  };
  for (const segmentation::PresegmentMethod method :
       {segmentation::PresegmentMethod::regions, segmentation::PresegmentMethod::edges,
        segmentation::PresegmentMethod::classes}) {
    segmentation::PresegmentParams p;
    p.method = method;
    for (const float hu : {0.f, 60.f}) EXPECT_EQ(refused(grid::Grid<float>(l, hu), p).code(), ExitCode::quality) << hu;
    grid::Grid<float> nan(l, 0.f);
    nan.at(1, 2, 3) = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(refused(nan, p).code(), ExitCode::bad_input);
    const grid::Field nothing(l, -1.f);
    grid::Field other = nothing;
    other.spacing_mm.y = 1.2;
    EXPECT_EQ(refused(ramp(), p, {&other, nullptr}).code(), ExitCode::bad_input) << "another raster";
    EXPECT_EQ(refused(grid::Grid<float>(l, 60.f), p, {&nothing, nullptr}).code(), ExitCode::quality) << "empty";
    p.roi_min_mm = {500, 500, 500};
    EXPECT_EQ(refused(ramp(), p).code(), ExitCode::quality) << "no voxel in the region";
  }
  segmentation::PresegmentParams p;
  p.lower_hu = 80;
  EXPECT_EQ(refused(ramp(), p).code(), ExitCode::usage);
  p = {};
  p.sides = segmentation::PresegmentSides::lower;
  EXPECT_EQ(refused(grid::Grid<float>(l, 60.f), p).code(), ExitCode::quality);
  p.method = segmentation::PresegmentMethod::classes;
  p.last_class = 3;
  EXPECT_EQ(refused(ramp(), p).code(), ExitCode::usage);
}

}  // namespace
}  // namespace trephine
