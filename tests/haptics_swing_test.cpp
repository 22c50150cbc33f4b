// SPDX-License-Identifier: GPL-3.0-or-later
// A running drill that lands on bone comes to rest on it, on any device, and swings no farther than on an uncut wall.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "device/simulated_hand.h"
#include "haptics/drilling.h"
#include "haptics/proxy.h"
#include "haptics_tools.h"

using namespace trephine;
using namespace trephine::tools;

namespace {

struct Landing {
  double push_n = 3, damping_n_s_per_mm = 0.003, mass_kg = 0.2, max_force_n = 20, diameter_mm = 5,
         stiffness_n_per_mm = 1;
};
struct Swing {
  double mm = 0, mm_per_s = 0;  ///< farthest off the surface after the first touch, and the fastest outward
  double late_mm_per_s = 0;     ///< the fastest outward from 0.8 s after the landing on
};

// A hand that pushes constantly lands at 20 mm/s on thick bone, with the drill on or off.
Swing land(const Landing& l, bool drills) {
  voxel::HapticVolume volume = empty(64, {0.5, 0.5, 0.5});
  fill(volume, 1, [](Vec3 p) { return 0.5 * std::min(-p.z, p.z + 14); });
  contact::ContactVolume contact(volume);
  haptics::Feels feels = untouchable();
  feels[1].front = feels[1].back = face(l.stiffness_n_per_mm, 0.35, 0.3, 0, 0.0003);
  drill::DrillShapes shapes;
  shapes[1] = {true, 0.1};
  haptics::DrillingParams params;
  params.drill = true;
  const haptics::ToolParams tool = haptics::own_tool(params_of("ball", l.diameter_mm));
  haptics::Drilling drilling(volume, contact, shapes, params, {}, haptics::cutter_of(params, tool));
  haptics::ForceParams force;
  force.max_force_n = l.max_force_n;
  haptics::Proxy proxy(contact, feels, force, {}, haptics::make_tool(tool));
  device::HandParams hand;
  hand.mass_kg = l.mass_kg;
  hand.device_damping_n_s_per_mm = l.damping_n_s_per_mm;
  hand.arm_damping_n_s_per_mm = hand.arm_stiffness_n_per_mm = 0;
  device::HandBody body;
  body.position_mm = {0.1, 0.2, 0.2};
  body.velocity = {0, 0, -20};
  Swing s;
  bool touched = false;
  for (int n = 0; n < 1600; ++n) {
    const bool waits = n < 600;  // until forces have risen after the start, the hand is held above the bone
    haptics::HapticInput in = pose(waits ? Vec3{0.1, 0.2, 0.2} : body.position_mm, {0, 0, 1});
    in.buttons = drills ? haptics::Drilling::pedal : 0;
    in.dt_s = in.period_s = 0.001;
    drilling.prepare(in);
    const haptics::HapticState is = proxy.update(in);
    drilling.tick(in, is);
    if (waits) continue;
    body.feel(is.force_n + Vec3{0, 0, -l.push_n});
    body.pull(hand, {}, body.position_mm, 0.001);
    touched = touched || norm(is.force_n) > 0.5;
    if (!touched) continue;
    s.mm = std::max(s.mm, body.position_mm.z);
    s.mm_per_s = std::max(s.mm_per_s, body.velocity.z);
    if (n > 1400) s.late_mm_per_s = std::max(s.late_mm_per_s, body.velocity.z);
  }
  return s;
}

void expect_calm(const Landing& l) {
  const Swing drilled = land(l, true), uncut = land(l, false);
  char text[160];
  std::snprintf(text, sizeof text, "%g N s/m, %g kg, %g N of %g, ball of %g mm, %g N/mm", 1e3 * l.damping_n_s_per_mm,
                l.mass_kg, l.push_n, l.max_force_n, l.diameter_mm, l.stiffness_n_per_mm);
  std::printf("  %s: outward %.0f mm/s, uncut %.0f; later %.1f, uncut %.1f\n", text, drilled.mm_per_s, uncut.mm_per_s,
              drilled.late_mm_per_s, uncut.late_mm_per_s);
  EXPECT_LE(drilled.mm, std::max(0.3, 1.2 * uncut.mm)) << text;
  EXPECT_LE(drilled.mm_per_s, 1.2 * uncut.mm_per_s + 1) << text;
  EXPECT_LE(drilled.late_mm_per_s, std::max(5.0, 1.2 * uncut.late_mm_per_s)) << text;
}

}  // namespace

TEST(HapticsSwing, ALandingDrillComesToRest) {
  for (const double damping : {0.002, 0.003, 0.006})
    for (const double push_n : {2.0, 3.0, 5.0}) expect_calm({push_n, damping});
}

// Also with other burrs, walls and hands.
TEST(LongHapticsSwing, ALandingDrillComesToRestOverTheGrid) {
  for (const double damping : {0.002, 0.003, 0.006})
    for (const double push_n : {1.0, 3.0, 5.0})
      for (const double max_n : {7.9, 20.0})
        for (const double mass_kg : {0.1, 0.5})
          for (const double diameter_mm : {3.0, 5.0, 7.0})
            for (const double stiffness : {0.5, 1.0})
              expect_calm({push_n, damping, mass_kg, max_n, diameter_mm, stiffness});
}
