// SPDX-License-Identifier: GPL-3.0-or-later
// The line lock [Rizzi, 5.5.1]: a tool that has entered bone or brain stays on the line by which it came in until it
// has left it.
#include <gtest/gtest.h>

#include "haptics_tools.h"

using namespace trephine;
using namespace trephine::tools;
using walls::uniform;

namespace {

constexpr double stiffness = 0.4, pops_n = 0.15;

// Brain (shape 1) below z = 0, and in it a ventricle (shape 2) below z = -10.
struct Head {
  voxel::HapticVolume volume = empty(60, {0.5, 0.5, 0.5});
  std::unique_ptr<contact::ContactVolume> contact;
  haptics::Feels feels = one_shape(1, face(stiffness, 0, 0, pops_n), face(stiffness, 0, 0, pops_n));
  Head() {
    fill(volume, 1, [](Vec3 p) { return std::min(-p.z, p.z + 10); });
    fill(volume, 2, [](Vec3 p) { return -10 - p.z; });
    feels[2].front.touchable = feels[2].back.touchable = false;
    contact = std::make_unique<contact::ContactVolume>(volume);
  }
  haptics::Proxy proxy(std::uint64_t locks, const haptics::ToolParams& tool = {},
                       const haptics::ForceParams& force = plain()) const {
    return haptics::Proxy(touch::FeltSpace(*contact, {nullptr, nullptr, locks}), feels, force, {},
                          haptics::make_tool(haptics::own_tool(tool)));
  }
};

struct Hand {
  haptics::Proxy& proxy;
  Vec3 tip, axis;
  std::uint32_t events = 0;
  haptics::HapticState go(Vec3 to_tip, Vec3 to_axis, int ticks = 200) {
    const Vec3 from = tip, from_axis = axis;
    haptics::HapticState is;
    for (int n = 1; n <= ticks; ++n) {
      tip = from + (to_tip - from) * (double(n) / ticks);
      axis = normalized(from_axis + (to_axis - from_axis) * (double(n) / ticks));
      is = proxy.update(pose(tip, axis));
      events |= is.events;
    }
    for (int n = 0; n < 100; ++n) is = proxy.update(pose(tip, axis));
    return is;
  }
};

double off_line(Vec3 p, Vec3 through, Vec3 axis) { return norm(cross(p - through, axis)); }

}  // namespace

TEST(HapticsLine, BeginsWhereAShapeIsEnteredAndEndsWhereItIsLeft) {
  const Head head;
  for (const char* kind : {"point", "needle", "catheter"}) {
    SCOPED_TRACE(kind);
    haptics::Proxy proxy =
        head.proxy(1u << 1, kind == std::string("point") ? haptics::ToolParams{} : params_of(kind, 1.5, 20, 1));
    const Vec3 axis = normalized(Vec3{0.2, 0.1, 1});
    Hand hand{proxy, axis * 8, axis};
    hand.go(axis * 3, axis);
    hand.go(axis * 3 + Vec3{2, 0, 0}, axis);
    EXPECT_EQ(hand.events & haptics::haptic_event::locked, 0u) << "above it";
    EXPECT_NEAR(proxy.state().proxy_mm.x, (axis * 3).x + 2, 1e-9) << "and free";
    hand.go(axis * 3, axis);
    haptics::HapticState is = hand.go(axis * -7, axis);
    ASSERT_EQ(is.inside, 1);
    EXPECT_NE(hand.events & haptics::haptic_event::locked, 0u);
    EXPECT_EQ(hand.events & haptics::haptic_event::unlocked, 0u);
    // Aside: it stays, and the wall presses with the shape's stiffness.
    const Vec3 aside = normalized(cross(axis, {0, 1, 0})) * 3;
    is = hand.go(axis * -7 + aside, axis);
    EXPECT_LT(off_line(is.proxy_mm, {}, axis), 0.02);
    EXPECT_NEAR(dot(is.force_n, normalized(aside)), -3 * stiffness, 0.05);
    EXPECT_NEAR(dot(is.force_n, axis), 0, 0.05) << "along it nothing but drag";
    // Turned: the shown tool keeps its orientation, and the hand feels a torque back.
    is = hand.go(axis * -7, normalized(axis + aside * 0.1));
    EXPECT_NEAR(dot(is.axis, axis), 1, 1e-6);
    EXPECT_GT(dot(is.torque_n_mm, cross(normalized(axis + aside * 0.1), axis)), 0);
    EXPECT_GT(norm(is.torque_n_mm), 20);
    // Farther in along its axis, and out; the hand stands 2 mm aside all the while.
    is = hand.go(axis * -9 + aside * 0.67, axis);
    EXPECT_NEAR(dot(is.proxy_mm, axis), -9, 0.1);
    EXPECT_LT(off_line(is.proxy_mm, {}, axis), 0.02);
    EXPECT_EQ(hand.events & haptics::haptic_event::unlocked, 0u);
    is = hand.go(axis * 4 + aside * 0.67, axis);
    EXPECT_NE(hand.events & haptics::haptic_event::unlocked, 0u);
    EXPECT_EQ(is.inside, 0);
    EXPECT_LT(norm(is.proxy_mm - hand.tip), 0.02) << "and follows the hand again";
    EXPECT_LT(norm(is.force_n), 0.01);
  }
}

TEST(HapticsLine, HoldsInTheNamedShapesAlone) {
  const Head head;
  const auto x_inside = [&](std::uint64_t locks, double depth) {
    haptics::Proxy proxy = head.proxy(locks);
    Hand hand{proxy, {0, 0, 5}, {0, 0, 1}};
    hand.go({0, 0, -depth}, {0, 0, 1});
    return std::abs(hand.go({3, 0, -depth}, {0, 0, 1}).proxy_mm.x);
  };
  EXPECT_LT(x_inside(1u << 1, 6), 0.01);
  EXPECT_NEAR(x_inside(0, 6), 3, 0.01);
  EXPECT_NEAR(x_inside(1u << 2, 6), 3, 0.01);
  EXPECT_NEAR(x_inside(1u << 1, 12), 3, 0.01) << "brain was left for the ventricle";
  EXPECT_LT(x_inside(1u << 1 | 1u << 2, 12), 0.01);
}

// Hands at random within it: the tip is on its line in every tick, but for a wall that it
// presses aslant; no force jumps, and who draws back comes out.
TEST(HapticsLine, NoHandLeavesTheLineOrIsCaught) {
  const Head head;
  std::mt19937_64 rng(5);
  double most_off = 0, most_step_n = 0;
  int caught = 0, ticks = 0;
  for (int session = 0; session < 60; ++session) {
    const bool point = session % 3 == 0;
    haptics::Proxy proxy =
        head.proxy(1u << 1, point ? haptics::ToolParams{} : params_of("needle", 1.5, 20, 1), haptics::ForceParams{});
    const Vec3 axis = normalized(Vec3{uniform(rng, -0.5, 0.5), uniform(rng, -0.5, 0.5), 1});
    Vec3 tip = axis * 5, aim_axis = axis, through, along;
    haptics::HapticState before;
    bool held = false;
    const auto move = [&](Vec3 to, Vec3 to_axis, int n_ticks) {
      const Vec3 from = tip, from_axis = aim_axis;
      for (int n = 1; n <= n_ticks; ++n, ++ticks) {
        tip = from + (to - from) * (double(n) / n_ticks);
        aim_axis = normalized(from_axis + (to_axis - from_axis) * (double(n) / n_ticks));
        const haptics::HapticState& is = proxy.update(pose(tip, aim_axis));
        if (is.events & haptics::haptic_event::locked) {
          held = true;
          through = is.proxy_mm;
          along = is.axis;
        }
        if (held) most_off = std::max(most_off, off_line(is.proxy_mm, through, along));
        if (is.events & haptics::haptic_event::unlocked) held = false;
        most_step_n = std::max(most_step_n, norm(is.force_n - before.force_n));
        before = is;
      }
    };
    move(axis * -4, axis, 150);
    for (int n = 0; n < 8; ++n)
      move({uniform(rng, -5, 5), uniform(rng, -5, 5), uniform(rng, -8, -1)},
           normalized(axis + Vec3{uniform(rng, -0.4, 0.4), uniform(rng, -0.4, 0.4), 0}), 20 + int(rng() % 100));
    move(tip + axis * 20, aim_axis, 200);
    for (int n = 0; n < 100; ++n) proxy.update(pose(tip, aim_axis));
    caught += norm(proxy.state().proxy_mm - tip) > 0.5 || norm(proxy.state().force_n) > 0.2;
  }
  std::printf("  %d ticks: off the line by at most %.6f mm, the force changes by at most %.3f N a tick; %d caught\n",
              ticks, most_off, most_step_n, caught);
  EXPECT_LT(most_off, pops_n / stiffness) << "a wall that the tip presses aslant moves it until that gives way";
  EXPECT_LE(most_step_n, 1.0001);  // max_force_rate_n_per_s
  EXPECT_EQ(caught, 0);
}
