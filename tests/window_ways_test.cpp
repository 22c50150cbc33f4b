// SPDX-License-Identifier: GPL-3.0-or-later
// The way of a recording that is shown as a ghost, and how hard a hand of mouse and keyboard pulls.
#include "window/ways.h"

#include <gtest/gtest.h>

#include "window/live_session.h"

using namespace trephine;

// It is the last tool's in the hand, and where that was asked for while the other one touched it is still the other's.
TEST(Ways, AGhostGoesTheWayOfTheToolInHand) {
  haptics::Recording r;
  r.header.tools.resize(2);
  const auto add = [&](std::uint32_t tool, double x_mm, int touched) {
    haptics::ServoFrame f;
    f.buttons = tool << haptics::belt_button::tool_shift;
    f.proxy_mm[0] = x_mm;
    f.touched = touched;
    r.frames.push_back(f);
  };
  for (int n = 0; n < 10; ++n) add(0, n, 1);
  for (int n = 10; n < 20; ++n) add(1, n, 1);  // refused
  std::vector<Vec3> way = window::way_of(r);
  ASSERT_FALSE(way.empty());
  EXPECT_EQ(way.front().x, 0);
  EXPECT_EQ(way.back().x, 19);
  for (int n = 20; n < 24; ++n) add(1, n, 0);
  for (int n = 30; n < 40; ++n) add(1, n, 1);
  way = window::way_of(r);
  EXPECT_EQ(way.front().x, 30) << "what the first tool did is no part of it";
  EXPECT_EQ(way.back().x, 39);
}

// A finder that is pushed through deep tissue comes into bone, and nobody pulls harder than a device can hold.
TEST(PiercingForce, IsWhatBoneAndTissueAskAndTheDeviceHolds) {
  haptics::BeltToolParams finder;
  finder.pierce_n = 2;
  finder.tool_length_mm = 80;
  cases::CaseHaptic haptic;
  EXPECT_NEAR(window::piercing_n(finder, haptic, 10), 2.5, 1e-12);
  haptic.shapes.resize(2);
  haptic.shapes[1].material.shaft_friction_n_per_mm = 0.012;
  haptic.shapes[1].material.tip_force_n = 0.15;
  EXPECT_NEAR(window::piercing_n(finder, haptic, 10), 2.5 + 0.96 + 0.15, 1e-12);
  EXPECT_LT(window::piercing_n(finder, haptic, 3.3), 3.3);
  EXPECT_GT(window::piercing_n(finder, haptic, 3.3), 3);
  finder.pierce_n = 0;
  EXPECT_EQ(window::piercing_n(finder, haptic, 3.3), 0);
}
