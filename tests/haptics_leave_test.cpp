// SPDX-License-Identifier: GPL-3.0-or-later
// A tool that was moved and turned in a hole comes out of it when the hand draws it out along its axis.
#include <gtest/gtest.h>

#include "haptics_tools.h"

using namespace trephine;
using namespace trephine::tools;
using walls::uniform;

namespace {

constexpr double top_mm = 4;

// Bone below the plane z = 4, with a hole down to z = -8.
voxel::HapticVolume block(double hole_radius_mm) {
  voxel::HapticVolume v = empty(56, {0.5, 0.5, 0.5});
  fill_wide(v, 1,
            [&](Vec3 p) { return std::min(top_mm - p.z, std::max(std::hypot(p.x, p.y) - hole_radius_mm, -8 - p.z)); });
  return v;
}

struct Session {
  const char* kind;
  double hole_radius_mm, tool_diameter_mm, speed;
  std::uint64_t seed;
  haptics::ForceParams::Law law = haptics::ForceParams::Law::third;
};

struct Left {
  double behind_mm = 0, force_n = 0;  ///< at the end: of the tool behind the device, and of the force
  bool was_locked = false;
};

// Into the hole, about in it at random, and out along the hand's axis to 13 mm above the rim.
Left leave(const Session& session, const contact::ContactVolume& contact) {
  std::mt19937_64 rng(session.seed);
  haptics::ToolParams tool = params_of(session.kind, session.tool_diameter_mm, 24, 1);
  haptics::ForceParams force = plain();
  force.force_law = session.law;
  haptics::Proxy proxy(contact, one_shape(1, face(1, 0.35, 0.3), face(1, 0.35, 0.3)), force, {},
                       haptics::make_tool(tool));
  Left left;
  Vec3 tip{0, 0, top_mm + 6}, axis{0, 0, 1};
  const auto move = [&](Vec3 to_tip, Vec3 to_axis, int ticks) {
    const Vec3 from = tip, from_axis = axis;
    for (int n = 1; n <= ticks; ++n) {
      tip = from + (to_tip - from) * (double(n) / ticks);
      axis = normalized(from_axis + (to_axis - from_axis) * (double(n) / ticks));
      left.was_locked = proxy.update(pose(tip, axis)).locked || left.was_locked;
    }
  };
  move({0, 0, uniform(rng, -6, 0)}, {0, 0, 1}, 40);
  for (int n = 0; n < 6; ++n) {
    const Vec3 to{uniform(rng, -4, 4), uniform(rng, -4, 4), uniform(rng, -7, 3)};
    const Vec3 lean = normalized({uniform(rng, -0.9, 0.9), uniform(rng, -0.9, 0.9), 1});
    move(to, lean, std::max(2, int(uniform(rng, 5, 60) / session.speed)));
  }
  move(tip + axis * ((top_mm + 13 - tip.z) / std::max(0.3, axis.z)), axis, std::max(4, int(100 / session.speed)));
  for (int n = 0; n < 60; ++n) proxy.update(pose(tip, axis));
  left.behind_mm = norm(proxy.state().proxy_mm - tip);
  left.force_n = norm(proxy.state().force_n);
  return left;
}

struct Outcome {
  int caught = 0, locked = 0;
};

Outcome sessions(int count, haptics::ForceParams::Law law, std::uint64_t seed) {
  Outcome out;
  for (const double hole_radius_mm : {1.5, 2.5, 4.0}) {
    voxel::HapticVolume volume = block(hole_radius_mm);
    const contact::ContactVolume contact(volume);
    std::mt19937_64 rng(seed);
    for (int n = 0; n < count / 3; ++n) {
      const char* kind = kinds[rng() % std::size(kinds)];
      const Session session{
          kind, hole_radius_mm, uniform(rng, 0.5, 0.95) * 2 * hole_radius_mm, uniform(rng, 0.5, 8), rng(), law};
      const Left left = leave(session, contact);
      out.locked += left.was_locked;
      if (!(left.behind_mm > 0.5) && !(left.force_n > 0.5)) continue;
      ++out.caught;
      if (law != haptics::ForceParams::Law::first)
        std::printf("  caught: %s of %.2f mm in a hole of %.1f mm radius, seed %llu, %.1f mm behind, %.1f N\n", kind,
                    session.tool_diameter_mm, hole_radius_mm, static_cast<unsigned long long>(session.seed),
                    left.behind_mm, left.force_n);
    }
  }
  return out;
}

}  // namespace

// One of these sessions is known to end jammed between two rims. To put the tool at the hand would free it, and would
// also carry tools through walls (HapticsTool.NoPointEverCrossesAWall), which is worse.
TEST(HapticsLeave, AlongTheAxisAToolComesOut) {
  const Outcome is = sessions(300, haptics::ForceParams::Law::third, 1);
  std::printf("  %d of 300 sessions locked, %d were caught\n", is.locked, is.caught);
  EXPECT_GT(is.locked, 20) << "else nothing was tried";
  EXPECT_LE(is.caught, 1);
}

// As before, for recordings: the lock could hold a tool for good, which these sessions must be able to show.
TEST(HapticsLeave, TheFirstLawCatchesSome) {
  const Outcome is = sessions(300, haptics::ForceParams::Law::first, 1);
  std::printf("  %d of 300 sessions locked, %d were caught\n", is.locked, is.caught);
  EXPECT_GT(is.caught, 0);
}

TEST(LongHapticsLeave, OfTenThousandSessionsHardlyOneIsCaught) {
  const Outcome is = sessions(10000, haptics::ForceParams::Law::third, 7);
  std::printf("  %d of 10,000 sessions locked, %d were caught\n", is.locked, is.caught);
  EXPECT_LE(is.caught, 60);
}
