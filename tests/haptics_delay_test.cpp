// SPDX-License-Identifier: GPL-3.0-or-later
// Walls behind a device with a delay: they stand, at the stiffness that its damping allows, and give no energy.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "device/simulated_hand.h"
#include "haptics/delayed_walls.h"
#include "haptics_scene.h"

using namespace trephine;
using namespace trephine::haptic_scenes;

namespace {

// Below z = 0 lies something hard, and beside it, where x is above 20, something softer.
struct TwoFloors {
  voxel::HapticVolume volume = empty(60, {2, 2, 2});
  haptics::Feels feels;
  std::unique_ptr<contact::ContactVolume> contact;
  explicit TwoFloors(double stiffness_n_per_mm) {
    feels = one_shape(1, face(stiffness_n_per_mm), face(stiffness_n_per_mm));
    feels[1].front.damping_n_s_per_mm = 0.0003;
    feels[1].drag_n_s_per_mm = 0.01;
    feels[2] = feels[1];
    feels[2].front = face(0.35 * stiffness_n_per_mm);
    fill(volume, 1, [](Vec3 p) { return std::min(-p.z, 20 - p.x); });
    fill(volume, 2, [](Vec3 p) { return std::min(-p.z, p.x - 20); });
    contact = std::make_unique<contact::ContactVolume>(volume);
  }
};

struct Hand {
  double mass_kg = 0.2, arm_n_per_mm = 0.4, arm_damping_n_s_per_mm = 0.004;
};
struct Wall {
  double device_damping_n_s_per_mm = 0.002, delay_ms = 1, max_force_n = 7.9;
};
struct Rest {
  double depth_mm = 0, force_n = 0, swing_mm = 0, drift_mm = 0;
};

// A hand presses with `push_n` at x, through a device that answers late. What it does in the eighth second is told.
Rest press(const TwoFloors& floors, const Hand& hand, const Wall& wall, double push_n, double x_mm) {
  haptics::ForceParams limits;
  limits.max_force_n = wall.max_force_n;
  limits.ramp_s = 0.05;
  haptics::PortParams port_params;
  port_params.device_delay_ms = wall.delay_ms;
  port_params.device_own_damping_n_s_per_mm = wall.device_damping_n_s_per_mm;
  const haptics::Feels feels = haptics::feels_behind(floors.feels, {}, port_params, 1000);
  haptics::Proxy proxy(*floors.contact, feels, limits);
  haptics::DevicePort port(port_params, limits);
  device::HandParams params;
  params.mass_kg = hand.mass_kg;
  params.device_damping_n_s_per_mm = wall.device_damping_n_s_per_mm;
  params.arm_damping_n_s_per_mm = hand.arm_damping_n_s_per_mm;
  params.arm_stiffness_n_per_mm = hand.arm_n_per_mm;
  const double stiffness = feels[x_mm > 20 ? 2 : 1].front.stiffness_n_per_mm;
  // Where the arm is a spring its aim lies so deep that it presses with push_n at rest; else the push is constant.
  const double arm_n_per_mm = hand.arm_n_per_mm;
  const Vec3 aim{x_mm, 0.1, arm_n_per_mm > 0 ? -push_n / stiffness - push_n / arm_n_per_mm : 0};
  const Vec3 constant{0, 0, arm_n_per_mm > 0 ? 0 : -push_n};
  device::HandBody body;
  body.position_mm = {x_mm, 0.1, 1};
  constexpr int fine = 4, most = 8000;
  const int late = int(std::lround(wall.delay_ms * fine));
  std::vector<Vec3> under_way(std::size_t(late) + 1);
  double low = 1e9, high = -1e9, before = 0, after = 0;
  Rest rest;
  int at_place = 0;
  Vec3 sent;
  for (int n = 0; n < most; ++n) {
    haptics::HapticInput in = at(body.position_mm);
    in.period_s = 0.001;
    port.before(in, false);
    sent = port.after(in, proxy.update(in)).force_n;
    for (int part = 0; part < fine; ++part) {  // all of the delay lies on the way to the hand
      under_way[std::size_t(at_place % (late + 1))] = sent;
      body.feel(under_way[std::size_t((at_place + 1) % (late + 1))] + constant);
      ++at_place;
      body.pull(params, {}, aim, 0.001 / fine);
    }
    if (n < most - 1000) continue;
    low = std::min(low, body.position_mm.z);
    high = std::max(high, body.position_mm.z);
    (n < most - 500 ? before : after) += body.position_mm.z / 500;
    rest.force_n += sent.z / 1000;
  }
  rest.depth_mm = -0.5 * (before + after);
  rest.drift_mm = std::abs(after - before);
  rest.swing_mm = high - low;
  return rest;
}

// The hand rests where push and stiffness say.
void expect_stands(const TwoFloors& floors, const Hand& hand, const Wall& wall, double push_n) {
  haptics::PortParams port;
  port.device_delay_ms = wall.delay_ms;
  port.device_own_damping_n_s_per_mm = wall.device_damping_n_s_per_mm;
  const haptics::Feels feels = haptics::feels_behind(floors.feels, {}, port, 1000);
  char text[160];
  std::snprintf(text, sizeof text, "%g N pushed, %g kg, arm %g N/mm and %g N s/m, device of %g N, %g N s/m, %g ms",
                push_n, hand.mass_kg, hand.arm_n_per_mm, 1e3 * hand.arm_damping_n_s_per_mm, wall.max_force_n,
                1e3 * wall.device_damping_n_s_per_mm, wall.delay_ms);
  double depth[2];
  for (const bool soft : {false, true}) {
    const double expected = push_n / feels[soft ? 2 : 1].front.stiffness_n_per_mm;
    if (expected > 50) return;  // the floors are 60 mm deep
    const Rest r = press(floors, hand, wall, push_n, soft ? 40 : -10);
    EXPECT_NEAR(r.depth_mm, expected, std::min(0.3, 0.05 * expected) + 0.01) << text << (soft ? ", soft" : "");
    EXPECT_NEAR(r.force_n, push_n, 0.05 * push_n) << text;
    EXPECT_LT(r.drift_mm, 0.05) << text;
    EXPECT_LT(r.swing_mm, 0.1) << text;
    depth[soft] = r.depth_mm;
  }
  EXPECT_GT(depth[1], 2 * depth[0]) << text << ": what is harder feels harder";
}

}  // namespace

TEST(HapticsDelay, AWallStands) {
  const TwoFloors floors(1.0);
  for (const double delay_ms : {0.5, 1.0, 2.0, 5.0})
    for (const double damping : {0.0005, 0.002, 0.006})
      for (const double push_n : {1.0, 2.5})
        for (const Hand& hand : {Hand{0.2, 0.4, 0.004}, Hand{0.2, 0, 0.004}, Hand{0.05, 0, 0.002}, Hand{0.5, 1, 0.004}})
          expect_stands(floors, hand, {damping, delay_ms, 7.9}, push_n);
}

// The whole grid, with a hand that nothing was set by: light, quick to yield, and on a device of 15 N.
TEST(LongHapticsDelay, AWallStandsOverTheGrid) {
  const TwoFloors bone(1.0), metal(3.2);
  for (const TwoFloors* floors : {&bone, &metal})
    for (const double delay_ms : {0.5, 1.0, 2.0, 3.0, 5.0})
      for (const double damping : {0.0005, 0.001, 0.002, 0.004, 0.006})
        for (const double max_n : {3.3, 7.9, 20.0, 40.0})
          for (const double mass_kg : {0.05, 0.2, 0.5})
            for (const double arm_n_per_mm : {0.0, 0.4, 1.0})
              for (const double share : {0.2, 0.7})
                expect_stands(*floors, {mass_kg, arm_n_per_mm, 0.004}, {damping, delay_ms, max_n}, share * max_n);
  for (const double delay_ms : {0.7, 1.6, 4.2})
    for (const double damping : {0.0008, 0.003})
      expect_stands(bone, {0.09, 0.15, 0.0025}, {damping, delay_ms, 15}, 0.9);
}

// Without the damping the controller of passivity lowers the force, and a wall that is pressed for long gives way.
TEST(HapticsDelay, AWallGivesWayWhereTheDampingIsNotKnown) {
  const TwoFloors floors(1.0);
  Wall unknown{0, 1, 7.9};
  const Rest r = press(floors, {0.2, 0.4, 0.006}, unknown, 2, -10);
  EXPECT_LT(r.force_n, 1.5) << "the wall stands: --allow-undamped and its warning are not needed";
}

TEST(HapticsDelay, RatiosFollowFromTheBound) {
  const TwoFloors floors(1.0);
  haptics::PortParams port;
  EXPECT_EQ(haptics::walls_behind(floors.feels, {}, port, 1000).stiffness_ratio, 1) << "without a delay";
  port.device_delay_ms = 2;
  EXPECT_EQ(haptics::walls_behind(floors.feels, {}, port, 1000).stiffness_ratio, 1) << "the damping is not known";
  port.device_own_damping_n_s_per_mm = 0.002;
  const haptics::DelayedWalls w = haptics::walls_behind(floors.feels, {}, port, 1000);
  // 0.8 * 2 N s/m, of which drag takes a quarter; a wall of 1 N/mm that is 2.5 ms late and damps by 0.3 N s/m.
  EXPECT_NEAR(w.drag_ratio, 0.0004 / 0.01, 1e-12);
  EXPECT_NEAR(w.stiffness_ratio, 0.0012 / 0.0028, 1e-12);
  haptics::FreeParams free;
  free.viscosity_n_s_per_mm = 0.01;
  const haptics::DelayedWalls with = haptics::walls_behind(floors.feels, free, port, 1000);
  EXPECT_NEAR(with.free_ratio, 0.04, 1e-12);
  EXPECT_NEAR(with.stiffness_ratio, 0.0008 / 0.0028, 1e-12);
  EXPECT_NEAR(haptics::free_behind(floors.feels, free, port, 1000).viscosity_n_s_per_mm, 0.0004, 1e-12);
}
