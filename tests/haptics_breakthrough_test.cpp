// SPDX-License-Identifier: GPL-3.0-or-later
// A drill comes through a plate: bone lets go of it as the free share of the burr grows, the breach is told when the
// burr is free, and nothing holds it in the open.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <deque>
#include <vector>

#include "device/simulated_hand.h"
#include "haptics/drilling.h"
#include "haptics/proxy.h"
#include "haptics_tools.h"

using namespace trephine;
using namespace trephine::tools;

namespace {

struct Push {
  double push_n = 3, diameter_mm = 5, voxel_mm = 0.5, damping_n_s_per_mm = 0.003;
  double slant = 0;     ///< of the plate's far side
  double dura_mm = 0;   ///< the gap to a dura behind it; 0: there is none
  double other_mm = 0;  ///< the gap to thick bone behind it; 0: there is none
  int pause_ms = 0;     ///< the pedal is up for so long once the tip is out
};
struct Through {
  double held_ms = -1;     ///< from the moment the tip leaves the plate until nothing of the plate is touched
  double event_ms = -1e9;  ///< when the breach was told, from then on
  int events = 0;
  double before_n = 0;   ///< felt before the tip leaves the plate, at most
  double free_n = 0;     ///< felt when nothing is touched any more
  double loose_mm = 0;   ///< how far the tool goes in other bone behind while next to nothing is felt
  double plunge_mm = 0;  ///< how far the hand goes from then on within 150 ms, in which nobody reacts
};

constexpr double plate_mm = 5, arm_n_per_mm = 0.4;
constexpr std::size_t reaction_ms = 150;

// A hand whose arm presses from where the hand was 150 ms ago drills through the plate.
Through go_through(const Push& p) {
  voxel::HapticVolume volume = empty(int(32 / p.voxel_mm), {p.voxel_mm, p.voxel_mm, p.voxel_mm});
  const auto far = [&](Vec3 q) { return -plate_mm + p.slant * q.x; };
  fill_wide(volume, 1, [&](Vec3 q) {
    const double plate = std::min(-q.z, q.z - far(q));
    return p.other_mm > 0 ? std::max(plate, far(q) - p.other_mm - q.z) : plate;
  });
  if (p.dura_mm > 0)
    fill_wide(volume, 2, [&](Vec3 q) {
      const double under_mm = far(q) - p.dura_mm - q.z;
      return std::min(under_mm, 2 - under_mm);
    });
  contact::ContactVolume contact(volume);
  haptics::Feels feels = untouchable();
  feels[1].front = feels[1].back = face(1, 0.35, 0.3, 0, 0.0003);
  feels[2].front = face(0.3, 0.3, 0.25, 0, 0.0002);
  drill::DrillShapes shapes;
  shapes[1] = {true, 0.1};
  haptics::DrillingParams params;
  params.drill = true;
  const haptics::ToolParams tool = haptics::own_tool(params_of("ball", p.diameter_mm));
  haptics::Drilling drilling(volume, contact, shapes, params, {}, haptics::cutter_of(params, tool));
  haptics::Proxy proxy(contact, feels, {}, {}, haptics::make_tool(tool));
  device::HandParams hand;
  hand.device_damping_n_s_per_mm = p.damping_n_s_per_mm;
  hand.arm_stiffness_n_per_mm = arm_n_per_mm;
  hand.arm_damping_n_s_per_mm = 0;
  device::HandBody body;
  const Vec3 begin{0.1, 0.2, 0.5};
  body.position_mm = begin;
  std::deque<Vec3> was(reaction_ms, begin);
  Through t;
  int left = -1, free = 0, event = -1;
  double was_mm = 0;
  std::vector<double> felt_n, hand_mm;
  for (int n = 0; n < 30000; ++n) {
    const bool waits = n < 600;  // until forces have risen after the start
    haptics::HapticInput in = pose(waits ? begin : body.position_mm, {0, 0, 1});
    in.buttons = left >= 0 && n < left + p.pause_ms ? 0 : haptics::Drilling::pedal;
    in.dt_s = in.period_s = 0.001;
    drilling.prepare(in);
    const haptics::HapticState is = proxy.update(in);
    drilling.tick(in, is);
    felt_n.push_back(norm(is.force_n));
    hand_mm.push_back(body.position_mm.z);
    if (waits) continue;
    if (is.touched == 1) free = n + 1;
    if (left < 0 && is.proxy_mm.z < far(is.proxy_mm)) left = n;
    if (is.events & haptics::haptic_event::breach) ++t.events, event = n;
    if (event >= 0 && n == std::max(event, free) + int(reaction_ms)) break;
    if (p.other_mm > 0 && is.proxy_mm.z < far(is.proxy_mm) - p.other_mm - 4) break;
    const double in_other_mm = far(is.proxy_mm) - p.other_mm - is.proxy_mm.z;
    if (p.other_mm > 0 && in_other_mm > 0.5 && felt_n.back() < 0.3) t.loose_mm += std::max(0.0, was_mm - is.proxy_mm.z);
    was_mm = is.proxy_mm.z;
    body.feel(is.force_n);
    body.pull(hand, {}, was.front() - Vec3{0, 0, p.push_n / arm_n_per_mm}, 0.001);
    body.position_mm.x = begin.x,
    body.position_mm.y = begin.y;  // what pushes aside at a slant is no matter of this test
    was.pop_front();
    was.push_back(body.position_mm);
  }
  const auto at = [](const std::vector<double>& v, int n) { return v[std::min(std::size_t(n), v.size() - 1)]; };
  t.held_ms = free - left;
  t.before_n = *std::max_element(felt_n.begin(), felt_n.begin() + std::max(left, 1));
  t.free_n = at(felt_n, free);
  t.plunge_mm = at(hand_mm, free) - at(hand_mm, free + int(reaction_ms));
  t.event_ms = event - left;
  std::printf(
      "  %g N, ball of %g mm in %g mm, %g N s/m, slant %g, dura at %g mm: held %.0f ms, told after %.0f, %.2f N before "
      "and %.2f N "
      "at the end, plunge %.1f mm\n",
      p.push_n, p.diameter_mm, p.voxel_mm, 1e3 * p.damping_n_s_per_mm, p.slant, p.dura_mm, t.held_ms, t.event_ms,
      t.before_n, t.free_n, t.plunge_mm);
  EXPECT_EQ(t.events, p.other_mm > 0 ? 0 : 1);
  return t;
}

void expect_lets_go(const Push& p) {
  const Through t = go_through(p);
  // A hand that presses less than the drill takes touches the last of the rim off and on.
  EXPECT_NEAR(t.event_ms, t.held_ms, p.push_n < 1.5 ? 250 : 15);
  EXPECT_LT(t.free_n, 0.3);
  EXPECT_GT(t.before_n, 0.6 * p.push_n) << "it holds until then";
}

}  // namespace

// A hand that presses goes through at once, and one that does not cuts its way.
TEST(HapticsBreakthrough, BoneLetsGoAsTheBurrComesFree) {
  for (const double push_n : {1.0, 2.0, 3.0}) expect_lets_go({push_n});
  EXPECT_LT(go_through({3}).held_ms, 60);
  EXPECT_GT(go_through({1}).held_ms, 100);
  Push slanted, coarse;
  slanted.slant = 0.5;
  expect_lets_go(slanted);
  coarse.voxel_mm = 0.8;
  expect_lets_go(coarse);
}

// What lies behind holds the tool while the bone goes.
TEST(HapticsBreakthrough, ADuraBehindItTakesTheTool) {
  Push p;
  p.dura_mm = 0.5;
  const Through t = go_through(p);
  EXPECT_GT(t.free_n, 0.2) << "it is pressed on";
  EXPECT_LT(t.event_ms, 100);
  EXPECT_LT(t.plunge_mm, 8);
}

// A burr that meets other bone before it is free, as in an air cell, is held by it.
TEST(HapticsBreakthrough, OtherBoneBehindHoldsIt) {
  for (const double gap_mm : {0.6, 1.0, 2.0})
    for (const double diameter : {3.0, 5.0}) {
      Push p;
      p.diameter_mm = diameter;
      p.other_mm = gap_mm;
      const double loose_mm = go_through(p).loose_mm;
      std::printf("    %.2f mm\n", loose_mm);
      EXPECT_LT(loose_mm, 0.3) << diameter << " mm, gap " << gap_mm;
    }
}

// A drill that stops when its tip is out, and goes on.
TEST(HapticsBreakthrough, APauseOfThePedalChangesNothing) {
  for (const int pause_ms : {30, 200}) {
    Push p;
    p.pause_ms = pause_ms;
    const Through t = go_through(p);
    EXPECT_LT(t.free_n, 0.3) << pause_ms;
    EXPECT_NEAR(t.event_ms, t.held_ms, 15) << pause_ms;
  }
}

TEST(LongHapticsBreakthrough, OverBurrsPushesAndHands) {
  for (const double diameter : {3.0, 5.0, 7.0})
    for (const double push : {0.5, 1.0, 2.0, 3.0})
      for (const double damping : {0.002, 0.006})
        for (const double slant : {0.0, 0.3})
          for (const double voxel_mm : {0.4, 0.6}) expect_lets_go({push, diameter, voxel_mm, damping, slant});
}
