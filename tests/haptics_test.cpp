// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <limits>

#include "haptics_scene.h"

using namespace trephine;
using namespace trephine::haptic_scenes;
using walls::uniform;
using walls::unit_vector;
using Surface = contact::ContactParams::Surface;

namespace {

const contact::ContactParams nearest_boxes{contact::ContactParams::Walk::exact, Surface::nearest, 1};

// Solid below z = 0.
voxel::HapticVolume floor_volume() {
  voxel::HapticVolume v = empty(40, {0.5, 0.5, 0.5});
  fill(v, 1, [](Vec3 p) { return -p.z; });
  return v;
}

}  // namespace

TEST(Haptics, ASpringOnAFloor) {
  voxel::HapticVolume v = floor_volume();
  const contact::ContactVolume contact(v);
  haptics::Proxy proxy(contact, one_shape(1, face(0.8), face(0.8)), plain());
  proxy.update(at({0, 0, 5}));
  EXPECT_EQ(proxy.state().force_n, Vec3{});
  EXPECT_EQ(proxy.state().touched, 0);
  const haptics::HapticState& s = proxy.update(at({0.3, 0.2, -1.5}));
  EXPECT_NEAR(s.force_n.z, 0.8 * 1.5, 2e-3);
  EXPECT_NEAR(norm(s.force_n), s.force_n.z, 1e-6);
  EXPECT_EQ(s.touched, 1);
  EXPECT_EQ(s.face, 1);
  EXPECT_EQ(s.held_by, 1);
  EXPECT_EQ(s.events, haptics::haptic_event::touch);
  proxy.update(at({0.35, 0.2, -1.5}));
  EXPECT_EQ(s.events, 0u);
  EXPECT_NEAR(s.proxy_mm.x, 0.35, 1e-3);  // no friction: it follows
  proxy.update(at({0.5, 0.2, -1.5}));
  EXPECT_EQ(s.events, haptics::haptic_event::motion);
  proxy.update(at({0.5, 0.2, 0.2}));
  EXPECT_EQ(s.events, haptics::haptic_event::untouch);
  EXPECT_EQ(s.force_n, Vec3{});
  EXPECT_EQ(s.proxy_mm, (Vec3{0.5, 0.2, 0.2}));
}

TEST(Haptics, FrictionHoldsInsideItsConeAndSlidesBeyond) {
  voxel::HapticVolume v = floor_volume();
  const contact::ContactVolume contact(v);
  haptics::Proxy proxy(contact, one_shape(1, face(1, 0.5, 0.3), face(1)), plain());
  const haptics::HapticState& s = proxy.state();
  proxy.update(at({0, 0, 1}));
  proxy.update(at({0, 0, -2}));
  const Vec3 first = s.proxy_mm;
  for (int n = 0; n < 3000; ++n) {  // up to 0.9 of what it holds, back and forth
    proxy.update(at({0.9 * std::sin(n * 0.01), 0, -2}));
    ASSERT_LT(norm(s.proxy_mm - first), 1e-9) << n;
  }
  for (int n = 0; n < 2000; ++n) proxy.update(at({0.002 * n, 0, -2}));
  EXPECT_NEAR(s.proxy_mm.x, 0.002 * 1999 - 0.3 * 2, 5e-3);  // behind by the dynamic ratio
  EXPECT_NEAR(s.force_n.x, -0.3 * s.force_n.z, 5e-3);
  EXPECT_NEAR(s.force_n.z, 2, 5e-3);
}

TEST(Haptics, ThreeSurfacesInACorner) {
  voxel::HapticVolume v = empty(40, {0.5, 0.5, 0.5});
  fill(v, 2, [](Vec3 p) { return std::max({-p.x, -p.y, -p.z}); });
  const contact::ContactVolume contact(v);
  haptics::Proxy proxy(contact, one_shape(2, face(1), face(1)), plain());
  const haptics::HapticState& s = proxy.state();
  proxy.update(at({5, 5, 5}));
  for (int n = 0; n < 50; ++n) proxy.update(at({-1, -2, -1.5}));
  EXPECT_GE(s.held_by, 1);
  EXPECT_NEAR(s.force_n.x, 1, 0.35);  // the corner of half occupancy is rounded by a part of a voxel
  EXPECT_NEAR(s.force_n.y, 2, 0.35);
  EXPECT_NEAR(s.force_n.z, 1.5, 0.35);
  for (int n = 0; n < 50; ++n) proxy.update(at({-1, 3 + 0.02 * n, -1.5}));
  EXPECT_NEAR(s.force_n.y, 0, 0.02);
  EXPECT_NEAR(s.proxy_mm.y, 3.98, 0.02);
}

bool well_within(const walls::Wall& w, Vec3 world_mm) {
  const Vec3 i = w.volume.voxels.to_index(world_mm);
  return std::min({i.x, i.y, i.z}) > 5 && std::max({i.x, i.y, i.z}) < 18;
}

// The nearest point satisfies the conditions of Karush, Kuhn and Tucker, which only the nearest does.
TEST(Haptics, TheNearestPointBeforeUpToThreePlanes) {
  std::mt19937_64 rng(13);
  int all_three = 0, none = 0;
  for (int n = 0; n < 20000; ++n) {
    contact::Plane planes[3];
    const int count = int(rng() % 4);
    for (int i = 0; i < count; ++i) planes[i] = {unit_vector(rng) * uniform(rng, 0, 2), unit_vector(rng)};
    const Vec3 target = unit_vector(rng) * uniform(rng, 0, 5);
    contact::Nearest near;
    if (!contact::nearest_before(planes, count, target, near)) {
      ++none;
      continue;
    }
    Vec3 sum = target;
    for (int i = 0; i < count; ++i) {
      const double before = dot(planes[i].normal, near.point_mm - planes[i].point_mm);
      EXPECT_GE(before, -1e-8);
      EXPECT_GE(near.pressure_mm[i], 0);
      EXPECT_LT(std::abs(near.pressure_mm[i] * before), 1e-6);
      sum += planes[i].normal * near.pressure_mm[i];
    }
    EXPECT_LT(norm(sum - near.point_mm), 1e-9);
    if (near.pressure_mm[0] > 0 && near.pressure_mm[1] > 0 && near.pressure_mm[2] > 0) ++all_three;
  }
  EXPECT_GT(all_three, 100);
  EXPECT_LT(none, 50);  // only where normals nearly depend on each other
}

// Strokes of any speed through walls of one voxel: the proxy stays on its side.
TEST(Haptics, TheProxyNeverCrossesAWall) {
  std::mt19937_64 rng(11);
  for (const voxel::HapticEncoding encoding : {voxel::HapticEncoding::occupancy, voxel::HapticEncoding::hu})
    for (walls::Wall& w : walls::all_walls(walls::lattice(24, {0.4, 0.4, 0.95}), encoding))
      for (const Surface surface : {Surface::subvoxel, Surface::nearest}) {
        const contact::ContactVolume contact(w.volume, {contact::ContactParams::Walk::exact, surface, 1});
        haptics::Proxy proxy(contact, one_shape(3, face(1, 0.3, 0.2), face(1, 0.3, 0.2)), plain());
        int crossed = 0, touching = 0;
        for (int stroke = 0; stroke < 120; ++stroke) {
          const walls::Way way = walls::random_way(w, 8, rng);
          Vec3 to = way.end_mm, x = way.start_mm;
          const int side = walls::side_of(w, way.start_mm);
          if (side == 0 || !well_within(w, x) || contact.shape_at(x) != 0) continue;
          proxy.reset();
          proxy.update(at(way.start_mm));
          const double speed = std::pow(10.0, uniform(rng, -3, 2));
          for (int n = 0; n < 200; ++n) {
            if (n % 40 == 39) to = x + unit_vector(rng) * 4;
            const Vec3 d = to - x;
            const Vec3 next = norm(d) > speed ? x + d * (speed / norm(d)) : to;
            if (!well_within(w, next)) {  // from its rim the wall may be walked round
              to = x;
              continue;
            }
            x = next;
            const haptics::HapticState& s = proxy.update(at(x));
            const int now = walls::side_of(w, s.proxy_mm);
            touching += s.touched != 0;
            if (now != 0 && now != side) ++crossed;
          }
        }
        EXPECT_EQ(crossed, 0) << w.name;
        EXPECT_GT(touching, 200) << w.name;
      }
}

TEST(Haptics, PopsThroughIsDraggedAndLeaves) {
  voxel::HapticVolume v = floor_volume();
  const contact::ContactVolume contact(v);
  haptics::Feels feels = one_shape(1, face(1, 0.3, 0.2, 2.0), {});
  feels[1].back.touchable = false;
  feels[1].drag_n_s_per_mm = 0.01;
  feels[1].shaft_friction_n_per_mm = 0.05;
  haptics::ShaftParams shaft;
  shaft.shaft_length_mm = 20;
  haptics::Proxy proxy(contact, feels, plain(), shaft);
  const haptics::HapticState& s = proxy.state();
  proxy.update(at({0, 0, 1}));
  double most = 0, z = 1;
  bool popped = false;
  for (; z > -8; z -= 0.01) {
    proxy.update(at({0, 0, z}));
    if (!popped) most = std::max(most, s.force_n.z);
    if (s.events & haptics::haptic_event::popped) {
      popped = true;
      EXPECT_NEAR(z, -2, 0.05);
    }
  }
  ASSERT_TRUE(popped);
  EXPECT_NEAR(most, 2, 0.03);
  EXPECT_EQ(s.inside, 1);
  EXPECT_EQ(s.touched, 0);
  EXPECT_NEAR(norm(s.proxy_mm - Vec3{0, 0, z + 0.01}), 0, 1e-9);
  // 10 mm/s: 0.1 N of drag, and 0.05 N for each of the 8 mm of shaft inside.
  EXPECT_NEAR(s.force_n.z, 0.1 + 0.05 * 8, 0.05);
  std::uint32_t seen = 0;
  for (; z < 2; z += 0.01) {
    proxy.update(at({0, 0, z}));
    seen |= s.events;
    if (s.inside == 1 && z > -7) {
      EXPECT_LT(s.force_n.z, 0) << z;  // held back now
    }
  }
  EXPECT_EQ(seen, haptics::haptic_event::left);
  EXPECT_EQ(s.inside, 0);
  for (; z > -1; z -= 0.01) proxy.update(at({0, 0, z}));
  EXPECT_EQ(s.touched, 1);  // the next time it is a surface again
}

TEST(Haptics, FacesAreTouchableOneByOne) {
  voxel::HapticVolume v = empty(40, {0.5, 0.5, 0.5});
  fill(v, 4, [](Vec3 p) { return 2 - std::abs(p.z); });
  const contact::ContactVolume contact(v);
  cases::CaseFace off;
  off.touchable = false;
  haptics::Proxy from_outside(contact, one_shape(4, face(1), off), plain()),
      from_inside(contact, one_shape(4, off, face(0.5)), plain());
  for (haptics::Proxy* p : {&from_outside, &from_inside}) {
    p->update(at({0, 0, 5}));
    p->update(at({0, 0, 1}));
  }
  EXPECT_NEAR(from_outside.state().force_n.z, 1, 5e-3);
  EXPECT_EQ(from_inside.state().force_n.z, 0);
  EXPECT_EQ(from_inside.state().inside, 4);
  from_inside.update(at({0, 0, 3}));
  EXPECT_NEAR(from_inside.state().force_n.z, -0.5, 5e-3);
  EXPECT_EQ(from_inside.state().face, 2);
}

// H1
TEST(Haptics, WhatIsNotFiniteLatchesZeroForce) {
  voxel::HapticVolume v = floor_volume();
  const contact::ContactVolume contact(v);
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                           -std::numeric_limits<double>::infinity(), 1e200})
    for (int what = 0; what < 7; ++what) {
      haptics::Proxy proxy(contact, one_shape(1, face(1, 0.5, 0.3, 0, 0.001), face(1)), plain());
      proxy.update(at({0, 0, 1}));
      proxy.update(at({0, 0, -1}));
      ASSERT_GT(proxy.state().force_n.z, 0.9);
      haptics::HapticInput in = at({0, 0, -1});
      (what < 3 ? in.tip_mm[what] : what < 6 ? in.axis[what - 3] : in.dt_s) = bad;
      proxy.update(in);
      EXPECT_EQ(proxy.state().force_n, Vec3{});
      EXPECT_EQ(proxy.state().faults, what < 6 ? haptics::haptic_fault::pose : haptics::haptic_fault::time_step);
      proxy.update(at({0, 0, -1}));
      EXPECT_EQ(proxy.state().force_n, Vec3{}) << "latched";
      EXPECT_TRUE(is_finite(proxy.state().proxy_mm));
      proxy.reset();
      proxy.update(at({0, 0, 1}));
      proxy.update(at({0, 0, -1}));
      EXPECT_GT(proxy.state().force_n.z, 0.9);
    }
}

// How long a loop may stand still is a parameter: a busy machine needs more than a device in a hand.
TEST(Haptics, ATickThatStandsForTooLongIsAFault) {
  voxel::HapticVolume v = floor_volume();
  const contact::ContactVolume contact(v);
  for (const double most_s : {1.0, 0.25, 60.0}) {
    haptics::ForceParams params = plain();
    if (most_s != 1) params.max_step_s = most_s;  // 1: as it is declared
    haptics::Proxy proxy(contact, one_shape(1, face(1), face(1)), params);
    proxy.update(at({0, 0, 1}));
    haptics::HapticInput in = at({0, 0, -1});
    in.dt_s = most_s;
    EXPECT_EQ(proxy.update(in).faults, 0u) << most_s;
    in.dt_s = 1.001 * most_s;
    EXPECT_EQ(proxy.update(in).faults, haptics::haptic_fault::time_step) << most_s;
    EXPECT_EQ(proxy.state().force_n, Vec3{});
  }
}

// H5: with the tip in bone there is no blow at the start.
TEST(Haptics, StartsInsideBoneWithAForceThatRises) {
  voxel::HapticVolume v = floor_volume();
  const contact::ContactVolume contact(v);
  haptics::ForceParams limits;
  haptics::Proxy proxy(contact, one_shape(1, face(1, 0.3, 0.2), face(1, 0.3, 0.2)), limits);
  double last = 0;
  for (int n = 0; n < 1000; ++n) {
    const haptics::HapticState& s = proxy.update(at({0.1, 0.2, -2}));
    EXPECT_LE(std::abs(s.force_n.z - last), 2.0 / 500 + 1e-4) << n;
    last = s.force_n.z;
    EXPECT_GT(s.proxy_mm.z, -0.01);
    EXPECT_EQ(s.inside, 0);
  }
  EXPECT_NEAR(last, 2, 0.02);
}

TEST(Haptics, ForceAndItsRateStayWithinTheDevice) {
  voxel::HapticVolume v = floor_volume();
  const contact::ContactVolume contact(v);
  haptics::ForceParams limits;
  limits.max_force_n = 3;
  limits.max_force_rate_n_per_s = 500;
  std::mt19937_64 rng(12);
  haptics::Proxy proxy(contact, one_shape(1, face(1, 0.5, 0.4, 2.5, 0.001), face(1, 0, 0, 1)), limits);
  Vec3 last, x{0, 0, 3};
  for (int n = 0; n < 50000; ++n) {
    x += unit_vector(rng) * std::pow(10.0, uniform(rng, -3, 1));
    for (int a = 0; a < 3; ++a) x[a] = std::clamp(x[a], -9.0, 9.0);
    const haptics::HapticState& s = proxy.update(at(x));
    ASSERT_LE(norm(s.force_n), 3 + 1e-12);
    ASSERT_LE(norm(s.force_n - last), 0.5 + 1e-9);
    last = s.force_n;
  }
  EXPECT_EQ(proxy.state().faults, 0u);
}

// A rate that is given counts; without one a strong device may change its whole force in 3.3 ms, as one of 3.3 N does.
TEST(Haptics, TheRateOfTheForceFollowsTheDevice) {
  const auto most_n = [](double max_force_n, double rate_n_per_s) {
    voxel::HapticVolume v = floor_volume();
    const contact::ContactVolume contact(v);
    haptics::ForceParams limits;
    limits.ramp_s = 0;
    limits.max_force_n = max_force_n;
    limits.max_force_rate_n_per_s = rate_n_per_s;
    haptics::Proxy proxy(contact, one_shape(1, face(100), face(100)), limits);
    proxy.update(at({0, 0, 1}));
    return norm(proxy.update(at({0, 0, -1})).force_n);
  };
  EXPECT_NEAR(most_n(3.3, 0), 1, 1e-9);
  EXPECT_NEAR(most_n(1, 0), 1, 1e-9);
  EXPECT_NEAR(most_n(40, 0), 12.1212, 1e-4);
  EXPECT_NEAR(most_n(40, 500), 0.5, 1e-9);
}

// Round a ball at a constant depth: constant force, nowhere caught, and not behind.
TEST(Haptics, RoundABallAtConstantDepth) {
  for (const Vec3 spacing : {Vec3{0.5, 0.5, 0.5}, Vec3{0.4, 0.4, 0.95}})
    for (const bool boxes : {false, true}) {
      voxel::HapticVolume v = empty(48, spacing);
      fill(v, 1, [](Vec3 p) { return 8 - norm(p); });
      const contact::ContactVolume contact(v, boxes ? nearest_boxes : contact::ContactParams{});
      haptics::Proxy proxy(contact, one_shape(1, face(1), face(1)), plain());
      double low = 9, high = 0, lag = 0;
      for (int n = 0; n < 20000; ++n) {
        const double a = 0.0025 * n, b = 0.3 * std::sin(0.0007 * n);
        const Vec3 u{std::cos(a) * std::cos(b), std::sin(a) * std::cos(b), std::sin(b)};
        const haptics::HapticState& s = proxy.update(at(u * (n == 0 ? 9 : 7)));
        if (n < 100) continue;
        low = std::min(low, norm(s.force_n));
        high = std::max(high, norm(s.force_n));
        lag = std::max(lag, norm(s.proxy_mm - u * dot(s.proxy_mm, u)));
      }
      std::printf("  spacing %.2f, %-9s force %.3f to %.3f N for 1, off by at most %.3f mm\n", spacing.z,
                  boxes ? "nearest" : "subvoxel", low, high, lag);
      EXPECT_GT(low, boxes ? 0.3 : 0.85);
      EXPECT_LT(high, boxes ? 2.2 : 1.15);
      EXPECT_LT(lag, boxes ? 1.3 : 0.3);
    }
}

// Between the samples of a stepped way lie corners of voxels: none of them keeps the proxy.
TEST(Haptics, TheSteppedWalkLeavesNoProxyInBone) {
  voxel::HapticVolume v = empty(60, {0.5, 0.5, 0.5});
  fill(v, 1, [](Vec3 p) { return 11 + std::sin(p.x) + std::cos(1.3 * p.y) - norm(p); });
  const haptics::Feels feels = one_shape(1, face(1, 0.3, 0.2), face(1, 0.3, 0.2));
  double share[2];
  for (const auto walk : {contact::ContactParams::Walk::exact, contact::ContactParams::Walk::stepped}) {
    const contact::ContactVolume contact(v, {walk, contact::ContactParams::Surface::nearest, 0.5});
    haptics::Proxy proxy(contact, feels, plain());
    std::mt19937_64 rng(12);
    proxy.update(at({14, 14, 14}));
    int touching = 0;
    for (int n = 0; n < 20000; ++n) {
      const haptics::HapticState& s =
          proxy.update(at({walls::uniform(rng, -14, 14), walls::uniform(rng, -14, 14), walls::uniform(rng, -14, 14)}));
      ASSERT_EQ(contact.shape_at(s.proxy_mm), 0) << n;
      ASSERT_EQ(s.inside, 0);
      touching += s.touched != 0;
    }
    share[walk == contact::ContactParams::Walk::stepped] = touching / 20000.0;
  }
  EXPECT_NEAR(share[0], share[1], 0.05);
}
