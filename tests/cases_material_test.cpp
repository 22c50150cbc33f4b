// SPDX-License-Identifier: GPL-3.0-or-later
// What makes a material sound.
#include "cases/material.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

namespace trephine {
namespace {

cases::MaterialParams bone() {
  cases::MaterialParams m;
  m.front.stiffness_n_per_mm = 1;
  m.front.damping_n_s_per_mm = 0.0003;
  m.front.static_friction_ratio = 0.35;
  m.front.dynamic_friction_ratio = 0.3;
  m.front.pop_through_n = 2;
  m.back = m.front;
  m.removal_energy_j_per_mm3 = 0.1;
  return m;
}

TEST(Material, FaultsNameFaceAndValue) {
  const auto fault = [](const std::function<void(cases::MaterialParams&)>& spoil) {
    cases::MaterialParams m = bone();
    spoil(m);
    return fault_of(parameters_of<cases::MaterialParams>(), &m);
  };
  EXPECT_EQ(fault([](cases::MaterialParams&) {}), "");
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  EXPECT_EQ(
      fault([&](cases::MaterialParams& m) { m.front.stiffness_n_per_mm = nan; }).rfind("front.stiffness_n_per_mm: ", 0),
      0u);
  EXPECT_EQ(
      fault([&](cases::MaterialParams& m) { m.back.damping_n_s_per_mm = inf; }).rfind("back.damping_n_s_per_mm: ", 0),
      0u);
  EXPECT_EQ(fault([](cases::MaterialParams& m) { m.drag_n_s_per_mm = -1; }),
            "drag_n_s_per_mm: -1, must be a number from 0 to 1");
  EXPECT_EQ(fault([&](cases::MaterialParams& m) { m.colour_rgb[1] = 1.5; }),
            "colour_rgb: [0.8, 1.5, 0.8], must be 3 numbers, each from 0 to 1");
  EXPECT_EQ(fault([](cases::MaterialParams& m) { m.front.dynamic_friction_ratio = 0.5; }),
            "front.dynamic_friction_ratio: 0.5, at most static_friction_ratio, 0.35");
  EXPECT_EQ(fault([](cases::MaterialParams& m) { m.back.stiffness_n_per_mm = 0; }),
            "back.stiffness_n_per_mm: 0, must be more where the face is touchable");
  EXPECT_EQ(fault([](cases::MaterialParams& m) { m.front.stiffness_n_per_mm = 0.05; }),
            "front.pop_through_n: 2 N are met 40 mm deep, at most 30 mm");
  EXPECT_EQ(fault([](cases::MaterialParams& m) { m.front.across_grain_ratio = 0.05; }),
            "front.across_grain_ratio: 0.05, must be a number from 0.1 to 10");
  EXPECT_EQ(fault([](cases::MaterialParams& m) { m.back.across_grain_ratio = 2; }),
            "grain_direction: is 0 long, at least 0.1 where across_grain_ratio is not 1");
  EXPECT_EQ(fault([](cases::MaterialParams& m) {
              m.front.across_grain_ratio = 0.5;
              m.grain_direction = {0.3, 0, -0.4};
            }),
            "");
  EXPECT_EQ(fault([&](cases::MaterialParams& m) {
              m.grain_direction = {0, nan, 0};
            }).rfind("grain_direction: ", 0),
            0u);
  EXPECT_EQ(fault([](cases::MaterialParams& m) { m.rest_ratio = 0.5; }).rfind("relaxation_s: is 0", 0), 0u);
  EXPECT_EQ(fault([](cases::MaterialParams& m) { m.relaxation_s = 0.5; }).rfind("rest_ratio: is 1", 0), 0u);
  EXPECT_EQ(fault([](cases::MaterialParams& m) { m.rest_ratio = m.relaxation_s = 0.5; }), "");
  EXPECT_EQ(fault([](cases::MaterialParams& m) {
              m.back = {};
              m.back.touchable = false;
            }),
            "");
}

}  // namespace
}  // namespace trephine
