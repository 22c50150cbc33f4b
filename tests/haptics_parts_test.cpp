// SPDX-License-Identifier: GPL-3.0-or-later
// The parts of a proxy, each alone: what holds it back, friction, and the way out of bone.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "haptics/sliding_friction.h"
#include "touch/way_out.h"

namespace {

using namespace trephine;
using haptics::HeldSurface;
using haptics::HeldSurfaces;

HeldSurface bone(int shape) {
  HeldSurface s;
  s.shape = shape;
  s.face = 1;
  s.feel.stiffness_n_per_mm = 2;
  s.feel.static_friction_ratio = 0.3;
  s.feel.dynamic_friction_ratio = 0.2;
  return s;
}

namespace {
tissue::Relaxations elastic(std::vector<tissue::SolidLaw>(64));  // nothing relaxes
}  // namespace

TEST(HapticsParts, AFloorAndAWallPressEachByItsDepth) {
  HeldSurfaces held;
  held.set(held.place_of({0, 0, 1}, 1), {{0, 0, 0}, {0, 0, 1}}, bone(1));
  held.set(held.place_of({1, 0, 0}, 1), {{0, 0, 0}, {1, 0, 0}}, bone(2));
  ASSERT_TRUE(held.solve({-1, 5, -3}));
  EXPECT_EQ(held.nearest_mm(), (Vec3{0, 5, 0}));
  const HeldSurfaces::Felt felt = held.felt(held.nearest_mm(), {-1, 5, -3}, {}, 0, elastic);
  EXPECT_NEAR(norm(felt.force_n - Vec3{2, 0, 6}), 0, 1e-12);
  EXPECT_EQ(felt.shape, 1);
  EXPECT_EQ(felt.count, 2);
  EXPECT_FALSE(held.presses_alone(0));
}

TEST(HapticsParts, OfTwoThatPressAlikeTheOneThatWasNamedStaysNamed) {
  HeldSurfaces held;
  held.set(0, {{0, 0, 0}, {0, 0, 1}}, bone(1));
  held.set(1, {{0, 0, 0}, {1, 0, 0}}, bone(2));
  ASSERT_TRUE(held.solve({-1, 0, -1.1}));
  EXPECT_EQ(held.felt({}, {-1, 0, -1.1}, {}, 2, elastic).shape, 2);
  EXPECT_EQ(held.felt({}, {-1, 0, -1.1}, {}, 1, elastic).shape, 1);
  ASSERT_TRUE(held.solve({-1, 0, -1.5}));
  EXPECT_EQ(held.felt({}, {-1, 0, -1.5}, {}, 2, elastic).shape, 1);
}

TEST(HapticsParts, AFourthSurfaceTakesThePlaceOfOneThatDoesNotPress) {
  HeldSurfaces held;
  EXPECT_EQ(held.put({{0, 0, 0}, {0, 0, 1}}, bone(1)), 0);
  EXPECT_EQ(held.put({{0, 0, 0}, {1, 0, 0}}, bone(2)), 1);
  EXPECT_EQ(held.put({{0, -9, 0}, {0, 1, 0}}, bone(3)), 2);  // far from the device
  ASSERT_TRUE(held.solve({-1, 0, -1}));
  EXPECT_EQ(held.put({{0, 0, 0}, {0, -1, 0}}, bone(4)), 2);
  EXPECT_TRUE(held.knows({0, -1, 0}, 1));
  EXPECT_FALSE(held.knows({0, 1, 0}, 1));
}

TEST(HapticsParts, StaticFrictionHoldsAndDynamicFrictionLeavesTheRest) {
  HeldSurfaces held;
  held.set(0, {{0, 0, 0}, {0, 0, 1}}, bone(1));
  haptics::SlidingFriction friction;
  Vec3 goal;
  ASSERT_TRUE(held.solve({0.29, 0, -1}));
  EXPECT_FALSE(friction.slide(held, 0, {0, 0, 0}, {0.29, 0, -1}, goal));
  ASSERT_TRUE(held.solve({0.31, 0, -1}));
  ASSERT_TRUE(friction.slide(held, 0, {0, 0, 0}, {0.31, 0, -1}, goal));
  EXPECT_NEAR(goal.x, 0.31 - 0.2, 1e-12);
  // It slides on where standing it would be held, until it rested.
  ASSERT_TRUE(held.solve({0.25, 0, -1}));
  EXPECT_TRUE(friction.slide(held, 0, {0, 0, 0}, {0.25, 0, -1}, goal));
  friction.rest();
  EXPECT_FALSE(friction.slide(held, 0, {0, 0, 0}, {0.25, 0, -1}, goal));
}

TEST(HapticsParts, TheWayOutLooksInAllDirectionsBeforeItGoesFarther) {
  touch::WayOut way_out;
  std::set<double> distances;
  int looks = 0;
  for (; looks < 28; ++looks) {
    const Vec3 to = way_out.next_mm({0, 0, 1});
    if (!(to == Vec3{})) distances.insert(std::round(norm(to) * 1e6));
  }
  EXPECT_EQ(distances, (std::set<double>{100000}));
  EXPECT_NEAR(norm(way_out.next_mm({0, 0, 1})), 0.125, 1e-12);
  for (; !way_out.exhausted() && looks < 10000; ++looks) way_out.next_mm({0, 0, 1});
  EXPECT_LT(looks, 1000);
}

}  // namespace
