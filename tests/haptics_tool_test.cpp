// SPDX-License-Identifier: GPL-3.0-or-later
// Tools with a body: their shells, what they feel of floors, holes and walls, how they lock and turn.
#include <gtest/gtest.h>

#include "base/error.h"
#include "haptics_tools.h"

using namespace trephine;
using namespace trephine::haptic_scenes;
using namespace trephine::tools;
using walls::uniform;
using walls::unit_vector;
using Search = haptics::ToolParams::Search;

TEST(HapticsTool, ShellsLieOnTheTool) {
  for (const char* kind : kinds) {
    const haptics::ToolParams own = haptics::own_tool(params_of(kind));
    const haptics::Tool tool = haptics::make_tool(params_of(kind));
    ASSERT_GE(tool.points_mm.size(), 64u);
    ASSERT_LE(tool.points_mm.size(), 400u);
    EXPECT_EQ(tool.points_mm.front(), Vec3{}) << "the tip";
    EXPECT_NEAR(tool.points_mm.back().z, own.tool_length_mm, 1e-9);
    EXPECT_EQ(tool.length_mm, own.tool_length_mm);
    double last = 0, widest = 0;
    const double r = own.tool_diameter_mm / 2;
    for (const Vec3& p : tool.points_mm) {
      EXPECT_GE(p.z, last - 1e-12) << "from the tip to the tail";
      last = p.z;
      const double x = std::hypot(p.x, p.y);
      widest = std::max(widest, x);
      const double z = p.z;
      double truth = r;
      if (own.tool_tip == haptics::ToolParams::Tip::cone) truth = std::min(r, z / 4);
      if (own.tool_tip == haptics::ToolParams::Tip::round && z < r) truth = std::sqrt(r * r - (r - z) * (r - z));
      if (own.tool_tip == haptics::ToolParams::Tip::flat && z == 0) truth = x;
      if (own.tool_tip == haptics::ToolParams::Tip::ball) {
        const double ball = z < 2 * r ? std::sqrt(std::max(0.0, r * r - (r - z) * (r - z))) : 0;
        truth = z < r || ball > r / 2 ? ball : r / 2;
      }
      EXPECT_NEAR(x, truth, 1e-9) << z;
    }
    EXPECT_LE(widest, r + 1e-9);
    // Nothing on the outside is far from a point.
    for (const Vec3& p : tool.points_mm) {
      double nearest = 1e9;
      for (const Vec3& q : tool.points_mm)
        if (q != p) nearest = std::min(nearest, norm(p - q));
      EXPECT_LE(nearest, own.tool_spacing_mm + 1e-9);
    }
  }
  EXPECT_TRUE(haptics::make_tool({}).points_mm.empty());
  const auto refused = [](const haptics::ToolParams& p, const char* field) {
    try {
      haptics::make_tool(p);
    } catch (const Error& e) {
      return e.code() == ExitCode::bad_config && e.field() == field;
    }
    return false;
  };
  EXPECT_TRUE(refused(params_of("catheter", 0, 0, 0.01), "tool_spacing_mm"));
  EXPECT_TRUE(refused(params_of("catheter", 10, 0, 0.4), "tool_spacing_mm"));
  EXPECT_TRUE(refused(params_of("burr", 10, 8), "tool_length_mm"));
}

TEST(HapticsTool, FramesTurnByTheLeast) {
  std::mt19937_64 rng(3);
  Mat3 f = haptics::frame_along({0, 0, 1});
  for (int n = 0; n < 2000; ++n) {
    const Vec3 to = n % 7 == 0 ? -f.column[2] : n % 5 == 0 ? f.column[2] : unit_vector(rng);
    const Mat3 g = haptics::turned(f, to);
    EXPECT_LT(norm(g.column[2] - to), 1e-12);
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t b = 0; b < 3; ++b) EXPECT_NEAR(dot(g.column[a], g.column[b]), a == b, 1e-12);
    EXPECT_NEAR(determinant(g), 1, 1e-12);
    const Vec3 about = normalized(cross(f.column[2], to));  // which the least rotation leaves alone
    EXPECT_LT(norm(g * transpose_times(f, about) - about), 1e-9);
    const Mat3 part = haptics::turned(f, to, 0.25);
    EXPECT_LE(std::acos(std::min(1.0, dot(part.column[2], f.column[2]))), 0.25 + 1e-7);
    f = g;
  }
}

// The ball of a burr rests on a plane at its radius, however the burr is held: the force is that of the depth.
TEST(HapticsTool, ABurrIsFeltAtItsRadius) {
  voxel::HapticVolume v = floor_volume();
  const contact::ContactVolume contact(v);
  std::mt19937_64 rng(4);
  for (const double spacing : {1.2, 0.5}) {
    const haptics::Tool burr = haptics::make_tool(params_of("burr", 5, 30, spacing));
    double worst = 0;
    for (int n = 0; n < 60; ++n) {
      const double tilt = n == 0 ? 0 : uniform(rng, 0, 1.2), turn = uniform(rng, 0, 6.28);
      const Vec3 axis{std::sin(tilt) * std::cos(turn), std::sin(tilt) * std::sin(turn), std::cos(tilt)};
      haptics::Proxy proxy(contact, one_shape(1, face(0.8), face(0.8)), plain(), {}, burr);
      const Vec3 to_tip = axis * -2.5;
      proxy.update(pose(Vec3{0.1, 0.2, 4} + to_tip, axis));
      EXPECT_EQ(proxy.state().force_n, Vec3{});
      for (double h = 4; h > 1.5; h -= 0.02) proxy.update(pose(Vec3{0.1, 0.2, h} + to_tip, axis));
      const haptics::HapticState& s = proxy.update(pose(Vec3{0.1, 0.2, 1.5} + to_tip, axis));
      worst = std::max(worst, std::abs(s.force_n.z - 0.8 * 1));
      EXPECT_LT(std::hypot(s.force_n.x, s.force_n.y), 0.01);
      EXPECT_LE(s.force_n.z, 0.8 + 2e-3) << "its points lie in the ball";
      if (n == 0) {
        EXPECT_NEAR(s.force_n.z, 0.8, 2e-3);  // on the pole
      }
      EXPECT_EQ(s.touched, 1);
      EXPECT_EQ(points_in(proxy, contact, 2), 0);
    }
    std::printf("  points %.1f mm apart (%zu): force off by at most %.3f N of 0.8\n", spacing, burr.points_mm.size(),
                worst);
    EXPECT_LT(worst, spacing > 1 ? 0.15 : 0.03);
  }
}

// A plate 10 mm thick with a hole along z, for a catheter of 2.5 mm.
struct Hole {
  voxel::HapticVolume volume = empty(64, {0.25, 0.25, 0.25});
  explicit Hole(double diameter_mm) {
    fill(volume, 1, [=](Vec3 p) { return std::min(5 - std::abs(p.z), std::hypot(p.x, p.y) - diameter_mm / 2); });
  }
};

TEST(HapticsTool, ACatheterInAHoleAlmostAsWide) {
  Hole hole(2.6);
  const contact::ContactVolume contact(hole.volume);
  for (const double lock : {3.0, 0.0}) {
    haptics::ToolParams p = params_of("catheter", 2.5, 60, 1);
    p.lock_distance_mm = lock;
    haptics::ForceParams limits;
    limits.ramp_s = 0;
    haptics::Proxy proxy(contact, one_shape(1, face(1, 0.3, 0.2), face(1, 0.3, 0.2)), limits, {},
                         haptics::make_tool(p));
    const haptics::HapticState& s = proxy.state();
    Vec3 last;
    std::uint32_t events = 0;
    const auto step = [&](Vec3 tip, Vec3 axis) {
      proxy.update(pose(tip, axis));
      ASSERT_TRUE(is_finite(s.force_n) && is_finite(s.proxy_mm) && is_finite(s.axis));
      ASSERT_LE(norm(s.force_n), limits.max_force_n + 1e-12);
      ASSERT_LE(norm(s.force_n - last), limits.force_rate_n_per_s() * 0.001 + 1e-12);
      ASSERT_EQ(points_in(proxy, contact, 2), 0) << "a point is in the wall";
      last = s.force_n;
      events |= s.events;
    };
    Vec3 tip{0, 0, 12}, axis{0, 0, 1};
    for (; tip.z > -6; tip.z -= 0.02) step(tip, axis);  // in
    EXPECT_LT(norm(s.proxy_mm - Vec3{0, 0, tip.z + 0.02}), 0.02) << "it goes in";
    const double play = 0.05 + 0.1 + 0.02;             // what the hole leaves, and its few points around
    for (; tip.x < 3; tip.x += 0.02) step(tip, axis);  // pulled sideways
    EXPECT_LT(std::hypot(s.proxy_mm.x, s.proxy_mm.y), play);
    EXPECT_LT(s.force_n.x, -2.5);
    for (; tip.x > 0; tip.x -= 0.02) step(tip, axis);
    for (double a = 0; a < 0.6; a += 0.001) step(tip, {std::sin(a), 0, std::cos(a)});  // twisted
    axis = {std::sin(0.6), 0, std::cos(0.6)};
    for (int n = 0; n < 200; ++n) step(tip, axis);
    EXPECT_LT(std::acos(s.axis.z), 2 * play / 10 + 0.01) << "it turned in the hole";
    EXPECT_EQ((events & haptics::haptic_event::locked) != 0, lock > 0);
    EXPECT_EQ(s.locked, lock > 0);
    const Vec3 held = s.axis;
    for (double a = 0; a < 0.3; a += 0.001) step(tip, {std::sin(0.6 + a), 0, std::cos(0.6 + a)});
    if (lock > 0) {
      EXPECT_EQ(s.axis, held) << "the lock holds";
    }
    for (double a = 0.9; a > 0; a -= 0.001) step(tip, {std::sin(a), 0, std::cos(a)});
    step(tip, {0, 0, 1});
    for (int n = 0; n < 200; ++n) step(tip, {0, 0, 1});
    EXPECT_FALSE(s.locked);
    EXPECT_LT(std::acos(std::min(1.0, s.axis.z)), 1e-6) << "turned back";
    for (double a = 0; a < 0.6; a += 0.001) step(tip, {0, std::sin(a), std::cos(a)});  // twisted, and backed out so
    const Vec3 back{0, std::sin(0.6), std::cos(0.6)};
    const Vec3 begin = tip;
    for (double z = 0; z < 25; z += 0.02) step(begin + Vec3{0, 0, z}, back);
    for (int n = 0; n < 200; ++n) step(begin + Vec3{0, 0, 25}, back);
    EXPECT_LT(norm(s.proxy_mm - (begin + Vec3{0, 0, 25})), 1e-6) << "it is out";
    EXPECT_LT(norm(s.axis - back), 1e-6) << "and free";
    EXPECT_EQ(s.force_n, Vec3{});
  }
}

// Skin that it pops through once, not once for every point; a hole in bone; brain.
TEST(HapticsTool, ANeedleThroughABurrHole) {
  voxel::HapticVolume v = empty(64, {0.5, 0.5, 0.5});
  fill(v, 1, [](Vec3 p) { return 0.6 - std::abs(p.z - 10); });
  fill(v, 2, [](Vec3 p) { return std::min(3 - std::abs(p.z), std::hypot(p.x, p.y) - 3); });
  fill(v, 3, [](Vec3 p) { return -5 - p.z; });
  const contact::ContactVolume contact(v);
  haptics::Feels feels = untouchable();
  feels[1].front = face(0.5, 0.1, 0.1, 0.4);
  feels[2].front = feels[2].back = face(1, 0.2, 0.2);
  feels[3].front = face(0.3, 0.1, 0.1, 0.3);
  haptics::Proxy proxy(contact, feels, plain(), {}, haptics::make_tool(params_of("needle", 1.27, 60, 1)));
  const haptics::HapticState& s = proxy.state();
  int popped = 0;
  double z = 14;
  const auto step = [&](Vec3 tip) {
    proxy.update(pose(tip, {0, 0, 1}));
    popped += (s.events & haptics::haptic_event::popped) != 0;
    ASSERT_EQ(points_in(proxy, contact, 4), 0) << "in bone";
  };
  for (; z > -12; z -= 0.01) step({0.2, 0, z});
  EXPECT_EQ(popped, 2) << "skin and brain, once each";
  EXPECT_EQ(s.inside, 3);
  EXPECT_LT(norm(s.proxy_mm - Vec3{0.2, 0, z + 0.01}), 1e-3);
  for (double x = 0.2; x < 6; x += 0.01) step({x, 0, z});  // the hole's wall is felt 12 mm above the tip
  EXPECT_NEAR(s.proxy_mm.x, 3 - 0.635, 0.25);
  EXPECT_EQ(s.touched, 2);
  EXPECT_NEAR(s.force_n.x, -(6 - (3 - 0.635)), 0.3);
  for (double x = 6; x > 0.2; x -= 0.01) step({x, 0, z});
  for (; z < 14; z += 0.01) step({0.2, 0, z});
  EXPECT_EQ(popped, 2);
  EXPECT_EQ(s.inside, 0);
  for (int n = 0; n < 40; ++n) step({0.2, 0, 14});
  for (; z > 9; z -= 0.01) step({0.2, 0, z});
  EXPECT_EQ(popped, 3) << "out of it, the skin is whole again";
}

// h on one wall, k on the other: their normals cancel, each wall is a constraint of its own, and the tool is caught.
TEST(HapticsTool, BetweenParallelWallsTheNormalsCancel) {
  voxel::HapticVolume v = empty(64, {0.5, 0.5, 0.5});
  fill(v, 1, [](Vec3 p) { return std::abs(p.x) - 8; });
  const contact::ContactVolume contact(v);
  for (const Search search : {Search::both, Search::tip_to_tail, Search::tail_to_tip})
    for (const double lock : {3.0, 0.0}) {
      haptics::ToolParams p = params_of("craniotome", 1, 24, 1);
      p.tool_search = search;
      p.lock_distance_mm = lock;
      haptics::Proxy proxy(contact, one_shape(1, face(1), face(1)), plain(), {}, haptics::make_tool(p));
      const haptics::HapticState& s = proxy.state();
      bool locked = false;
      // About its middle: both ends come to the walls at once.
      for (double a = 0; a < 1.1; a += 0.001) {
        const Vec3 axis{std::sin(a), 0, std::cos(a)};
        proxy.update(pose(axis * -12, axis));
        locked = locked || (s.events & haptics::haptic_event::locked);
        ASSERT_EQ(points_in(proxy, contact, 2), 0) << a;
        ASSERT_LT(norm(s.force_n), 30);
      }
      EXPECT_EQ(locked, lock > 0 && search == Search::both);
      // 24 sin a + cos a = 16 where it is caught.
      const double a = std::asin(s.axis.x);
      EXPECT_NEAR(24 * std::sin(a) + std::cos(a), 16, 0.5);
      EXPECT_LT(norm(s.proxy_mm + s.axis * 12), 8) << "it stays about where it was";
    }
}

// A groove of two slopes, met by both ends at once: averaged, its normal is up; from one end, that end's slope.
TEST(HapticsTool, TheSearchSaysWhoseNormalCounts) {
  voxel::HapticVolume v = empty(48, {0.5, 0.5, 0.5});
  fill(v, 1, [](Vec3 p) { return (0.5 * std::abs(p.x) - p.z - 6) / std::hypot(0.5, 1); });
  const contact::ContactVolume contact(v);
  for (const Search search : {Search::both, Search::tip_to_tail, Search::tail_to_tip}) {
    haptics::Tool tool;  // a bar
    for (int n = 0; n <= 10; ++n) tool.points_mm.push_back({0, 0, double(n)});
    tool.length_mm = 10;
    tool.search = search;
    haptics::Proxy proxy(contact, one_shape(1, face(1, 0.9, 0.9), face(1)), plain(), {}, tool);
    const haptics::HapticState& s = proxy.state();
    proxy.update(pose({-5, 0, 0}, {1, 0, 0}));
    proxy.update(pose({-5, 0, -4}, {1, 0, 0}));
    const double slope = s.normal.x;
    EXPECT_NEAR(slope, search == Search::both ? 0 : search == Search::tip_to_tail ? 0.447 : -0.447, 0.03);
    EXPECT_NEAR(s.proxy_mm.z, -3.5, 0.05);
  }
}

// Tables V and VI: lying on a floor and turned into it about its tip.
TEST(HapticsTool, LocksAndUnlocks) {
  voxel::HapticVolume v = floor_volume(64);
  const contact::ContactVolume contact(v);
  haptics::Proxy proxy(contact, one_shape(1, face(1), face(1)), plain(), {},
                       haptics::make_tool(params_of("needle", 1, 12, 1)));
  const haptics::HapticState& s = proxy.state();
  double z = 2;
  for (; z > 0.4; z -= 0.01) proxy.update(pose({-5, 0, z}, {1, 0, 0}));
  EXPECT_FALSE(s.locked) << "nothing turned";
  const auto tilt = [&](double a) {
    proxy.update(pose({-5, 0, z}, {std::cos(a), 0, std::sin(a)}));
    EXPECT_EQ(points_in(proxy, contact, 2), 0);
  };
  std::uint32_t events = 0;
  for (double a = 0; a > -0.3; a -= 0.002) {
    tilt(a);
    events |= s.events;
  }
  EXPECT_TRUE(events & haptics::haptic_event::locked);
  EXPECT_TRUE(s.locked);
  const Vec3 held = s.axis;
  EXPECT_NEAR(held.z, 0, 0.02);
  for (double a = -0.3; a < held.z - 0.01; a += 0.002) {
    tilt(a);
    ASSERT_TRUE(s.locked) << a;
    ASSERT_EQ(s.axis, held);
  }
  proxy.update(pose({-4, 1, z}, {1, 0, -0.05}));
  EXPECT_TRUE(s.locked);
  EXPECT_NEAR(s.proxy_mm.x, -4, 1e-2) << "it may still be moved";
  tilt(0.05);
  EXPECT_FALSE(s.locked);
  EXPECT_EQ(s.events & haptics::haptic_event::unlocked, haptics::haptic_event::unlocked);
  EXPECT_LT(norm(s.axis - Vec3{std::cos(0.05), 0, std::sin(0.05)}), 1e-9);
}

TEST(HapticsTool, FrictionHoldsATool) {
  voxel::HapticVolume v = floor_volume();
  const contact::ContactVolume contact(v);
  for (const char* kind : {"burr", "craniotome"}) {
    haptics::Proxy proxy(contact, one_shape(1, face(1, 0.5, 0.3), face(1)), plain(), {},
                         haptics::make_tool(params_of(kind)));
    const haptics::HapticState& s = proxy.state();
    proxy.update(pose({0, 0, 1}, {0.1, 0.2, 1}));
    proxy.update(pose({0, 0, -2}, {0.1, 0.2, 1}));
    const Vec3 first = s.proxy_mm;
    const double depth = first.z + 2;
    for (int n = 0; n < 2000; ++n) {
      proxy.update(pose({0.45 * depth * std::sin(n * 0.01), 0, -2}, {0.1, 0.2, 1}));
      ASSERT_LT(norm(s.proxy_mm - first), 2e-3) << n;
    }
    for (int n = 0; n < 1500; ++n) proxy.update(pose({0.002 * n, 0, -2}, {0.1, 0.2, 1}));
    EXPECT_NEAR(s.proxy_mm.x, 0.002 * 1499 - 0.3 * depth, 1e-2);
    EXPECT_NEAR(s.force_n.x, -0.3 * s.force_n.z, 1e-2);
  }
}
