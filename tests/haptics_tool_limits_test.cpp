// SPDX-License-Identifier: GPL-3.0-or-later
// What holds for every tool whatever the hand does: the way out of bone, walls that none crosses, the device's limits.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "haptics_tools.h"

using namespace trephine;
using namespace trephine::haptic_scenes;
using namespace trephine::tools;
using walls::uniform;
using walls::unit_vector;
using Search = haptics::ToolParams::Search;

namespace {

bool same_state(const haptics::HapticState& a, const haptics::HapticState& b) {
  return a.force_n == b.force_n && a.proxy_mm == b.proxy_mm && a.axis == b.axis && a.normal == b.normal &&
         a.touched == b.touched && a.inside == b.inside && a.events == b.events && a.locked == b.locked;
}

}  // namespace

// H5: with the tool in bone there is no blow at the start, and no point is left in it.
TEST(HapticsTool, StartsInsideBone) {
  voxel::HapticVolume v = floor_volume();
  const contact::ContactVolume contact(v);
  for (const char* kind : kinds) {
    haptics::Proxy proxy(contact, one_shape(1, face(1, 0.3, 0.2), face(1, 0.3, 0.2)), haptics::ForceParams{}, {},
                         haptics::make_tool(params_of(kind)));
    double last = 0;
    for (int n = 0; n < 600; ++n) {
      const haptics::HapticState& s = proxy.update(pose({0.1, 0.2, -3}, {0.1, 0, 1}));
      ASSERT_EQ(points_in(proxy, contact, 2), 0);
      EXPECT_LE(std::abs(norm(s.force_n) - last), 3.2 / 500 + 5e-3) << n;
      last = norm(s.force_n);
    }
    EXPECT_NEAR(last, 3, 0.2);  // the rim of a tilted one lies lower than its tip
  }
}

// The way out of a heap of splinters, in which each pose has another point in bone, is looked for in a bounded part of
// each frame, without a force until it is found.
TEST(HapticsTool, FindsItsWayOutOfBoneInShortFrames) {
  voxel::HapticVolume v = empty(110, {1, 1, 1});
  fill(v, 1, [](Vec3 p) {
    const auto at = [](double x) { return int(std::floor(x / 3)); };
    const bool splinter = ((at(p.x) * 7 + at(p.y) * 13 + at(p.z) * 5) % 4 + 4) % 4 == 0;
    return splinter && norm(p) < 50 ? 1.0 : -1.0;
  });
  const contact::ContactVolume contact(v);
  int max_frames = 0;
  for (const char* kind : kinds) {
    const haptics::Tool tool = haptics::make_tool(params_of(kind));
    haptics::Proxy proxy(contact, one_shape(1, face(1, 0.3, 0.2), face(1, 0.3, 0.2)), haptics::ForceParams{}, {}, tool);
    int frames = 1;
    std::uint64_t looked_at = 0;
    for (;; ++frames) {
      const haptics::HapticState& s = proxy.update(pose({3, 2, 1}, {0.3, 0, 1}));
      EXPECT_LE(proxy.tool_body()->looked_at() - looked_at, 4000 + 2 * tool.points_mm.size());
      looked_at = proxy.tool_body()->looked_at();
      if (points_in(proxy, contact, 2) == 0) break;
      ASSERT_EQ(s.force_n, Vec3{});
      ASSERT_LT(frames, 20);
    }
    max_frames = std::max(max_frames, frames);
    // Begun anew outside it is there at once.
    proxy.reset();
    proxy.update(pose({3, 2, 60}, {0, 0, 1}));
    EXPECT_EQ(proxy.state().proxy_mm, (Vec3{3, 2, 60}));
  }
  EXPECT_GT(max_frames, 1);
}

namespace {

// Any tool, any turn, any speed, through walls of one voxel: no point of it is ever on another side than it was.
void thrash(int strokes, std::uint64_t seed) {
  std::mt19937_64 rng(seed);
  long crossed = 0, touching = 0, ticks = 0, locked = 0, turned_back = 0;
  for (const voxel::HapticEncoding encoding : {voxel::HapticEncoding::occupancy, voxel::HapticEncoding::hu})
    for (walls::Wall& w : walls::all_walls(walls::lattice(36, {0.4, 0.4, 0.6}), encoding))
      for (const auto surface : {contact::ContactParams::Surface::subvoxel, contact::ContactParams::Surface::nearest}) {
        const contact::ContactVolume contact(w.volume, {contact::ContactParams::Walk::exact, surface, 1});
        for (int stroke = 0; stroke < strokes; ++stroke) {
          haptics::ToolParams p = params_of(kinds[rng() % 5], uniform(rng, 0.3, 1), 2.6, uniform(rng, 0.3, 0.8));
          p.tool_search = Search(rng() % 3);
          p.lock_distance_mm = rng() % 2 ? 0.7 : 0;
          haptics::Proxy proxy(contact, one_shape(3, face(1, 0.3, 0.2), face(1, 0.3, 0.2)), plain(), {},
                               haptics::make_tool(p));
          const auto within = [&](Vec3 x) {
            const Vec3 i = w.volume.voxels.to_index(x);
            return std::min({i.x, i.y, i.z}) > 11 && std::max({i.x, i.y, i.z}) < 24;
          };
          const walls::Way way = walls::random_way(w, 6, rng);
          Vec3 x = way.start_mm, to = way.end_mm, axis = unit_vector(rng), towards = unit_vector(rng);
          if (!within(x)) continue;
          for (int n = 0; n == 0 || (n < 20 && points_in(proxy, contact, 8) > 0); ++n) proxy.update(pose(x, axis));
          const haptics::ToolBody& b = *proxy.tool_body();
          std::vector<int> side(std::size_t(b.count()));
          for (int i = 0; i < b.count(); ++i) side[std::size_t(i)] = walls::side_of(w, b.at_mm(i));
          const double speed = std::pow(10.0, uniform(rng, -3, 2)), turn = std::pow(10.0, uniform(rng, -4, 0.5));
          for (int n = 0; n < 120; ++n) {
            if (n % 30 == 29) {
              to = x + unit_vector(rng) * 4;
              towards = unit_vector(rng);
            }
            axis = haptics::turned(haptics::frame_along(axis), towards, turn).column[2];
            const Vec3 d = to - x, next = norm(d) > speed ? x + d * (speed / norm(d)) : to;
            if (within(next))
              x = next;
            else
              to = x;
            const haptics::HapticState& s = proxy.update(pose(x, axis));
            ++ticks;
            touching += s.touched != 0;
            locked += s.locked;
            turned_back += norm(s.axis - axis) > 1e-3;
            ASSERT_TRUE(is_finite(s.force_n));
            for (int i = 0; i < b.count(); ++i) {
              const int now = walls::side_of(w, b.at_mm(i));
              int& was = side[std::size_t(i)];
              if (now == 0) {  // in the wall, or at the border, where a way leads around it
                const Vec3 at = w.volume.voxels.to_index(b.at_mm(i));
                if (std::min({at.x, at.y, at.z}) < 1 || std::max({at.x, at.y, at.z}) > 34) was = 0;
                continue;
              }
              crossed += was != 0 && now != was;
              if (was != 0) was = now;
            }
          }
        }
      }
  std::printf("  %ld ticks, in contact %ld, locked %ld, kept from turning %ld, points that crossed %ld\n", ticks,
              touching, locked, turned_back, crossed);
  EXPECT_EQ(crossed, 0);
  EXPECT_GT(touching, ticks / 10);
  EXPECT_GT(locked, 20);
}

}  // namespace

TEST(HapticsTool, NoPointEverCrossesAWall) { thrash(40, 21); }
TEST(LongHapticsTool, NoPointEverCrossesAWall) { thrash(1500, 22); }

// Forces stay within the device's limits, whatever the hand does; and two runs are the same bit for bit.
TEST(HapticsTool, ForceAndItsRateStayWithinTheDevice) {
  voxel::HapticVolume v = empty(48, {0.5, 0.5, 0.5});
  fill(v, 1, [](Vec3 p) { return std::min(-p.z, std::hypot(p.x - 1, p.y) - 2); });
  fill(v, 2, [](Vec3 p) { return 1 - std::abs(p.z - 6); });
  const contact::ContactVolume contact(v);
  haptics::Feels feels = one_shape(1, face(1, 0.5, 0.4, 0, 0.001), face(1, 0, 0, 0));
  feels[2].front = feels[2].back = face(0.5, 0.3, 0.2, 0.5);
  feels[2].drag_n_s_per_mm = 0.003;
  feels[2].shaft_friction_n_per_mm = 0.02;
  haptics::ForceParams limits;
  limits.max_force_n = 3;
  limits.max_force_rate_n_per_s = 500;
  for (const char* kind : kinds) {
    const haptics::Tool tool = haptics::make_tool(params_of(kind));
    std::mt19937_64 rng(12);
    haptics::Proxy proxy(contact, feels, limits, {}, tool), again(contact, feels, limits, {}, tool);
    Vec3 last, x{0, 0, 9}, axis{0, 0, 1};
    int touching = 0, popped = 0, away = 0;
    for (int n = 0; n < 10000; ++n) {
      x += unit_vector(rng) * std::pow(10.0, uniform(rng, -3, 0.7));
      for (int a = 0; a < 3; ++a) x[a] = std::clamp(x[a], -9.0, 11.0);
      axis = normalized(axis + unit_vector(rng) * std::pow(10.0, uniform(rng, -4, n % 100 == 0 ? 1 : -1)));
      axis.z = std::max(axis.z, 0.3);  // it does not come round the volume's rim from below
      const haptics::HapticState& s = proxy.update(pose(x, axis));
      ASSERT_TRUE(is_finite(s.force_n) && is_finite(s.proxy_mm) && is_finite(s.axis));
      ASSERT_LE(norm(s.force_n), 3 + 1e-12);
      ASSERT_LE(norm(s.force_n - last), 0.5 + 1e-9);
      ASSERT_TRUE(same_state(s, again.update(pose(x, axis))));
      last = s.force_n;
      touching += s.touched != 0;
      popped += (s.events & haptics::haptic_event::popped) != 0;
      if (n % 500 != 499) continue;
      // Drawn away from everything it comes: nothing holds it.
      for (int m = 0; m < 300; ++m) {
        x.z = std::min(x.z + 0.2, 30.0);
        axis = haptics::turned(haptics::frame_along(axis), {0, 0, 1}, 0.05).column[2];
        proxy.update(pose(x, axis));
        again.update(pose(x, axis));
      }
      away += norm(s.proxy_mm - x) < 1e-6;
      last = s.force_n;
    }
    EXPECT_EQ(proxy.state().faults, 0u);
    EXPECT_GT(touching, 1000);
    EXPECT_GT(popped, 10);
    EXPECT_EQ(away, 20);
  }
}

// H1
TEST(HapticsTool, WhatIsNotFiniteLatchesZeroForce) {
  voxel::HapticVolume v = floor_volume();
  const contact::ContactVolume contact(v);
  const haptics::Tool tool = haptics::make_tool(params_of("burr"));
  for (int what = 0; what < 7; ++what) {
    haptics::Proxy proxy(contact, one_shape(1, face(1), face(1)), plain(), {}, tool);
    proxy.update(at({0, 0, 1}));
    proxy.update(at({0, 0, -1}));
    ASSERT_GT(proxy.state().force_n.z, 0.9);
    haptics::HapticInput in = at({0, 0, -1});
    (what < 3 ? in.tip_mm[what] : what < 6 ? in.axis[what - 3] : in.dt_s) = std::nan("");
    proxy.update(in);
    EXPECT_EQ(proxy.state().force_n, Vec3{});
    EXPECT_EQ(proxy.state().faults, what < 6 ? haptics::haptic_fault::pose : haptics::haptic_fault::time_step);
    EXPECT_TRUE(is_finite(proxy.state().proxy_mm));
  }
}
