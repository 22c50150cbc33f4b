// SPDX-License-Identifier: GPL-3.0-or-later
// Tools that are exactly round, balls and rods: where they touch, what they press, that they go through nothing, and
// their time.
#include <gtest/gtest.h>
#include <time.h>

#include "haptics/round_body.h"
#include "haptics_tools.h"

using namespace trephine;
using namespace trephine::tools;
using walls::uniform;
using walls::unit_vector;

namespace {

double cpu_us() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return double(t.tv_sec) * 1e6 + double(t.tv_nsec) * 1e-3;
}

}  // namespace

// Pressed into planes of any direction, the force is the spring's, along the normal, and the tip is a radius ahead.
TEST(HapticsRound, ASpringOnPlanes) {
  std::mt19937_64 rng(1);
  double worst = 0, tilted = 0;
  for (int n = 0; n < 20; ++n) {
    const Vec3 up = unit_vector(rng);
    voxel::HapticVolume v = empty(48, {0.5, 0.5, 0.5});
    fill_wide(v, 1, [&](Vec3 p) { return -dot(p, up); });
    const contact::ContactVolume contact(v);
    haptics::Proxy proxy(contact, one_shape(1, face(1), face(1)), plain(), {},
                         haptics::make_tool(params_of("ball", uniform(rng, 1, 6))));
    proxy.update(pose(up * 4, up));
    // The axis points away from the surface: the tip is the point that touches.
    for (double z = 4; z > -1; z -= 0.02) proxy.update(pose(up * z, up));
    const haptics::HapticState& is = proxy.update(pose(up * -1, up));
    worst = std::max(worst, std::abs(dot(is.force_n, up) - 1));
    tilted = std::max(tilted, norm(is.force_n - up * dot(is.force_n, up)));
    EXPECT_EQ(is.touched, 1);
    EXPECT_NEAR(dot(is.proxy_mm, up), 0, 0.03);
  }
  EXPECT_LT(worst, 0.03);
  EXPECT_LT(tilted, 0.06);
}

// Round a ball, and in a bowl, at a constant depth.
TEST(HapticsRound, RoundABallAndInABowl) {
  for (const bool bowl : {false, true}) {
    voxel::HapticVolume v = empty(64, {0.5, 0.5, 0.5});
    fill_wide(v, 1, [&](Vec3 p) { return bowl ? norm(p) - 9 : 8 - norm(p); });
    const contact::ContactVolume contact(v);
    haptics::Proxy proxy(contact, one_shape(1, face(1), face(1)), plain(), {},
                         haptics::make_tool(params_of("ball", 3)));
    double low = 9, high = 0;
    for (int n = 0; n < 8000; ++n) {
      const double a = 0.0025 * n, b = 0.3 * std::sin(0.0007 * n);
      const Vec3 u{std::cos(a) * std::cos(b), std::sin(a) * std::cos(b), std::sin(b)};
      const double r = bowl ? (n == 0 ? 6 : 10) : n == 0 ? 9 : 7;  // of the tip
      const haptics::HapticState& s = proxy.update(pose(u * r, bowl ? -u : u));
      if (n < 100) continue;
      low = std::min(low, norm(s.force_n));
      high = std::max(high, norm(s.force_n));
    }
    std::printf("  %s: force %.3f to %.3f N for 1\n", bowl ? "bowl" : "ball", low, high);
    EXPECT_GT(low, 0.9);
    EXPECT_LT(high, 1.1);
  }
}

// A body that moved and turned remembers what it saw about its last places; one that begins there sees the same.
TEST(HapticsRound, WhatIsRememberedIsWhatIsThere) {
  const auto level = [](Vec3 p) { return 9 + std::sin(p.x) + std::cos(1.3 * p.y) - norm(p); };
  voxel::HapticVolume v = empty(64, {0.5, 0.5, 0.5});
  fill_wide(v, 1, level);
  const contact::ContactVolume contact(v);
  const contact::TouchableFaces faces{2, 2};
  std::mt19937_64 rng(7);
  for (const char* tool : {"rod", "round_burr", "matchstick"}) {
    const std::vector<haptics::RoundPart> parts = haptics::make_tool(params_of(tool, 3)).round;
    ASSERT_FALSE(parts.empty()) << tool;
    haptics::RoundBody moved(contact, parts);
    Vec3 at{0, 0, 9}, axis{0, 0, 1};
    int hits = 0;
    for (int n = 0; n < 400; ++n) {
      // Small steps about the wall, and now and then a leap, as where a session begins anew.
      const Vec3 step{uniform(rng, -1, 1), uniform(rng, -1, 1), uniform(rng, -1, 1)};
      at = n % 40 == 39 ? unit_vector(rng) * 9.5 : at + step * 0.1;
      if (norm(at) < 8.5 || norm(at) > 11) at = normalized(at) * 9.5;
      axis = normalized(axis + Vec3{uniform(rng, -1, 1), uniform(rng, -1, 1), uniform(rng, -1, 1)} * 0.05);
      moved.begin_frame();
      const int inside = contact.shape_at(at);
      const haptics::RoundBody::Touch a = moved.deepest(at, axis, inside, faces);
      // A new body zeroes megabytes, so every fourth place gets one: the leaps are among these.
      if (n % 4 != 3) continue;
      haptics::RoundBody fresh(contact, parts);
      fresh.begin_frame();
      const haptics::RoundBody::Touch b = fresh.deepest(at, axis, inside, faces);
      ASSERT_EQ(a.hit, b.hit) << tool << ", step " << n;
      if (!a.hit) continue;
      ++hits;
      ASSERT_EQ(a.depth_mm, b.depth_mm) << tool << ", step " << n;
      ASSERT_EQ(a.along_mm, b.along_mm) << tool << ", step " << n;
      ASSERT_EQ(a.contact.point_mm, b.contact.point_mm) << tool << ", step " << n;
      ASSERT_EQ(a.contact.normal, b.contact.normal) << tool << ", step " << n;
    }
    EXPECT_GT(hits, 50) << tool;
  }
}

// Random strokes of any speed against bumpy walls: the ball is never in bone by more than its discs are rough.
TEST(HapticsRound, GoesThroughNothing) {
  const auto level = [](Vec3 p) { return 10 + std::sin(p.x) + std::cos(1.3 * p.y) - norm(p); };
  voxel::HapticVolume v = empty(72, {0.5, 0.5, 0.5});
  fill_wide(v, 1, level);
  const contact::ContactVolume contact(v);
  haptics::Proxy proxy(contact, one_shape(1, face(1, 0.3, 0.2), face(1, 0.3, 0.2)), plain(), {},
                       haptics::make_tool(params_of("ball", 2)));
  std::mt19937_64 rng(12);
  Vec3 x{14, 9, 9}, to = x;
  proxy.update(pose(x, {0, 0, 1}));
  double deepest = 0;
  int touching = 0, inside = 0;
  for (int n = 0; n < 30000; ++n) {
    if (n % 50 == 0) to = {uniform(rng, -15, 15), uniform(rng, -15, 15), uniform(rng, -15, 15)};
    const double speed = std::pow(10.0, uniform(rng, -3, 1.5));
    const Vec3 d = to - x;
    x = norm(d) > speed ? x + d * (speed / norm(d)) : to;
    const haptics::HapticState& s = proxy.update(pose(x, {0, 0, 1}));
    const Vec3 centre = s.proxy_mm + Vec3{0, 0, 1};
    for (int m = 0; m < 20; ++m) deepest = std::max(deepest, std::min(1.0, level(centre + unit_vector(rng)) / 1.7));
    inside += contact.shape_at(centre) != 0;
    touching += s.touched != 0;
  }
  std::printf("  in contact %.0f %%, at most %.3f mm in\n", touching / 300.0, deepest);
  EXPECT_GT(touching, 5000);
  EXPECT_EQ(inside, 0) << "its centre";
  EXPECT_LT(deepest, 0.15);
}

TEST(HapticsRound, PopsThroughAndLeaves) {
  voxel::HapticVolume v = empty(48, {0.5, 0.5, 0.5});
  fill_wide(v, 1, [](Vec3 p) { return 1 - std::abs(p.z); });
  const contact::ContactVolume contact(v);
  haptics::Feels feels = one_shape(1, face(1, 0, 0, 0.5), face(1));
  feels[1].back.touchable = false;
  haptics::Proxy proxy(contact, feels, plain(), {}, haptics::make_tool(params_of("ball", 2)));
  std::uint32_t seen = 0;
  double most = 0;
  for (double z = 5; z > -8; z -= 0.02) {
    const haptics::HapticState& s = proxy.update(pose({0, 0, z}, {0, 0, 1}));
    seen |= s.events;
    most = std::max(most, s.force_n.z);
  }
  EXPECT_TRUE(seen & haptics::haptic_event::popped);
  EXPECT_NEAR(most, 0.5, 0.05);
  EXPECT_NEAR(proxy.state().proxy_mm.z, -8, 0.1) << "it is through";
  for (double z = -8; z < 5; z += 0.02) proxy.update(pose({0, 0, z}, {0, 0, 1}));
  for (double z = 5; z > 0.7; z -= 0.02) proxy.update(pose({0, 0, z}, {0, 0, 1}));
  EXPECT_EQ(proxy.state().touched, 1) << "closed again";
}

// What it popped through does not push it on from behind while it is halfway in, also where the back can be touched.
TEST(HapticsRound, HalfwayThroughASkinNothingPushesItOn) {
  voxel::HapticVolume v = empty(64, {0.5, 0.5, 0.5});
  fill_wide(v, 1, [](Vec3 p) { return 3 - std::abs(p.z + 2); });
  const contact::ContactVolume contact(v);
  for (const char* kind : {"ball", "rod"}) {
    haptics::Proxy proxy(contact, one_shape(1, face(1, 0, 0, 0.5), face(1, 0, 0, 0.5)), plain(), {},
                         haptics::make_tool(params_of(kind, 2)));
    double most = 0, least = 0;
    int popped = 0;
    for (double z = 4; z > -4; z -= 0.01) {
      const haptics::HapticState& s = proxy.update(pose({0, 0, z}, {0, 0, 1}));
      popped += (s.events & haptics::haptic_event::popped) != 0;
      most = std::max(most, s.force_n.z);
      least = std::min(least, s.force_n.z);
    }
    EXPECT_EQ(popped, 1) << kind;
    EXPECT_NEAR(most, 0.5, 0.05) << kind;
    EXPECT_GT(least, -1e-6) << kind << " was drawn in";
    EXPECT_NEAR(proxy.state().proxy_mm.z, -4, 0.1) << kind;
  }
}

// 2 mm wide at 20 mm/s over bumps: their mean tick, beside a burr of points.
TEST(HapticsRound, TheirTicks) {
  voxel::HapticVolume v = empty(64, {0.8, 0.8, 0.8});
  fill_wide(v, 1, [](Vec3 p) { return (18 + std::sin(0.5 * p.x) + std::cos(0.4 * p.y) - norm(p)) / 1.2; });
  const contact::ContactVolume contact(v);
  struct Run {
    const char* what;
    haptics::ToolParams tool;
    bool flat;
    double max_us;
  };
  for (const Run& run :
       {Run{"ball", params_of("ball", 2), false, 240}, Run{"round burr", params_of("round_burr", 2), false, 400},
        Run{"rod, upright", params_of("rod", 2), false, 400}, Run{"rod, flat", params_of("rod", 2), true, 1200},
        Run{"burr of points", params_of("burr", 2, 3, 0.6), false, 10000}}) {
    haptics::Proxy proxy(contact, one_shape(1, face(1, 0.3, 0.2), face(1, 0.3, 0.2)), plain(), {},
                         haptics::make_tool(run.tool));
    std::vector<double> us;
    int touching = 0;
    for (int n = 0; n < 12000; ++n) {
      const double a = 0.02 * n / 17;
      const Vec3 u{std::cos(a), 0.3 * std::sin(0.4 * a), std::sin(a)};
      const haptics::HapticInput in = pose(u * (n == 0 ? 22 : 17), run.flat ? cross(u, Vec3{0, 1, 0}) : u);
      const double begin = cpu_us();
      touching += proxy.update(in).touched != 0;
      us.push_back(cpu_us() - begin);
    }
    double mean = 0;
    for (const double t : us) mean += t / double(us.size());
    std::sort(us.begin(), us.end());
    std::printf("  %s: mean %.1f, p99 %.1f us, in contact %.0f %%\n", run.what, mean, us[us.size() * 99 / 100],
                touching / 120.0);
    EXPECT_LT(mean, run.max_us) << run.what << "; a twentieth of that on a machine that nobody shares";
    EXPECT_GT(touching, 8000) << run.what;
  }
}
