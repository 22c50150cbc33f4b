// SPDX-License-Identifier: GPL-3.0-or-later
// Transfer functions: what is seen of HU, and what of that is touched.
#include "voxel/transfer.h"

#include <gtest/gtest.h>

#include "base/error.h"

namespace trephine::voxel {
namespace {

TransferFunction of(std::vector<std::array<double, 2>> points, double touched_from = 0.5) {
  TransferFunction f;
  for (const auto& p : points) f.points.push_back({p[0], p[1], {p[1], 0.5, 1 - p[1]}});
  f.touched_from_opacity = touched_from;
  return f;
}

TEST(VoxelTransfer, IsLinearBetweenItsPointsAndGoesOnBeyondThem) {
  const TransferFunction f = of({{100, 0}, {300, 0.8}, {300, 1}, {500, 0.5}});
  EXPECT_EQ(at_hu(f, -1024).opacity, 0);
  EXPECT_DOUBLE_EQ(at_hu(f, 150).opacity, 0.2);
  EXPECT_DOUBLE_EQ(at_hu(f, 150).colour_rgb[0], 0.2);
  EXPECT_NEAR(at_hu(f, 299.999).opacity, 0.8, 1e-5);
  EXPECT_EQ(at_hu(f, 300).opacity, 1) << "the upper point of a step";
  EXPECT_DOUBLE_EQ(at_hu(f, 400).opacity, 0.75);
  EXPECT_EQ(at_hu(f, 3071).opacity, 0.5);
}

TEST(VoxelTransfer, WhatIsOpaqueIsTouchedFromAThreshold) {
  using Range = std::array<int, 2>;
  const TransferFunction ramp = of({{100, 0}, {300, 1}});
  EXPECT_EQ(touched_hu(ramp), (Range{200, 32767}));
  EXPECT_EQ(touched_hu(of({{100, 0}, {300, 1}}, 0.25)), (Range{150, 32767}));
  EXPECT_EQ(touched_hu(of({{100, 0}, {200, 1}, {400, 1}, {500, 0}})), (Range{150, 450}));
  // The dissertation's window is the special case.
  const TransferFunction window = window_function(227, 900, {1, 1, 1});
  EXPECT_EQ(window.fault(), "");
  for (const double from : {0.01, 0.5, 1.0}) {
    TransferFunction f = window;
    f.touched_from_opacity = from;
    EXPECT_EQ((*touched_hu(f))[1], 900);
    EXPECT_EQ((*touched_hu(f))[0], 227);
  }
  EXPECT_EQ(touched_hu(window_function(227, 32767, {1, 1, 1})), (Range{227, 32767}));
  EXPECT_EQ(touched_hu(window_function(227, 3000, {1, 1, 1})), (Range{227, 3000}));
}

TEST(VoxelTransfer, PresetsAreWhole) {
  for (const char* name : {"bone", "skin", "vessels"}) {
    TransferFunction f;
    f.preset = name;
    EXPECT_EQ(f.fault(), "") << name;
    EXPECT_TRUE(resolved(f).preset.empty());
    EXPECT_EQ(resolved(f).fault(), "") << name;
    EXPECT_TRUE(touched_hu(resolved(f))) << name;
  }
}

TEST(VoxelTransfer, EachFaultHasOneLine) {
  EXPECT_EQ(TransferFunction().fault(), "points: 0, must be 2 or more, or give a preset (bone, skin, vessels)");
  EXPECT_EQ(of({{100, 0}}).fault(), "points: 1, must be 2 or more, or give a preset (bone, skin, vessels)");
  EXPECT_EQ(of({{100, 0}, {50, 1}}).fault(), "points[1].hu: 50, must be at least 100: points ascend");
  EXPECT_EQ(of({{100, 0}, {100, 1}, {100, 0.5}}).fault(),
            "points[2].hu: 100, three points lie there, at most two may (a step)");
  EXPECT_EQ(of({{100, 0.5}, {200, 1}}).fault(),
            "points[0].opacity: 0.5, must be 0: so opaque is what lies below it, air too");
  EXPECT_EQ(of({{-1024, 0}, {-1024, 1}}).fault(),
            "points[0].opacity: 1, must be 0: so opaque is what lies below it, air too");
  EXPECT_EQ(of({{100, 0}, {200, 0.4}}).fault(),
            "touched_from_opacity: 0.5, must be at most 0.4, the largest opacity: nothing would be touched");
  EXPECT_EQ(of({{0, 0}, {100, 1}, {200, 0}, {300, 1}}).fault(),
            "touched_from_opacity: 0.5, several ranges of HU are so opaque, must be one: give each a shape of its own");
  TransferFunction both = of({{100, 0}, {200, 1}});
  both.preset = "bone";
  EXPECT_EQ(both.fault(), "points: are there beside a preset: give one of the two");
}

TEST(VoxelTransfer, StiffnessIsLinearBetweenItsPointsToo) {
  TransferFunction f = of({{100, 0}, {300, 0.8}, {300, 1}, {500, 0.4}});
  EXPECT_EQ(stiffest_n_per_mm(f), 0);
  const double stiffness[] = {0.2, 0.6, 1.0, 3.0};
  for (std::size_t n = 0; n < 4; ++n) f.points[n].stiffness_n_per_mm = stiffness[n];
  EXPECT_EQ(f.fault(), "");
  EXPECT_DOUBLE_EQ(at_hu(f, 150).stiffness_n_per_mm, 0.3);
  EXPECT_DOUBLE_EQ(at_hu(f, 300).stiffness_n_per_mm, 1.0);
  EXPECT_DOUBLE_EQ(at_hu(f, 400).stiffness_n_per_mm, 2.0);
  EXPECT_EQ(at_hu(f, 3000).stiffness_n_per_mm, 3.0);
  EXPECT_DOUBLE_EQ(stiffest_n_per_mm(f), 1.0 + 2.0 * 166 / 200) << "of what is touched, to 466 HU";
  f.points[2].stiffness_n_per_mm = 0;
  EXPECT_EQ(f.fault(), "points[2].stiffness_n_per_mm: 0, must be above 0 at all points or be at none");
}

TEST(VoxelTransfer, IsReadFromACommandLine) {
  EXPECT_EQ(transfer_from_text("bone", "--transfer").points.size(), preset_points("bone").size());
  const TransferFunction f = transfer_from_text("150:0:e0c0a0,300.5:0.9:ffffff", "--transfer");
  ASSERT_EQ(f.points.size(), 2u);
  EXPECT_EQ(f.points[1].hu, 300.5);
  EXPECT_EQ(f.points[1].opacity, 0.9);
  EXPECT_NEAR(f.points[0].colour_rgb[0], 224 / 255.0, 1e-12);
  EXPECT_NEAR(f.points[0].colour_rgb[2], 160 / 255.0, 1e-12);
  const auto refused = [](const std::string& text) -> std::string {
    try {
      transfer_from_text(text, "--transfer");
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::usage);
      return e.what();
    }
    return "";
  };
  for (const char* bad : {"bones", "150:0", "150:0:e0c0a", "150:0:-e0c0a", "x:0:ffffff,1:1:ffffff", "150:2:ffffff",
                          "5000:0:ffffff,6000:1:ffffff", "300:0:ffffff,150:1:ffffff", "nan:0:ffffff", ""})
    EXPECT_FALSE(refused(bad).empty()) << bad;
  EXPECT_NE(refused("150:0:ffffff,140:1:ffffff").find("points ascend"), std::string::npos);
}

}  // namespace
}  // namespace trephine::voxel
