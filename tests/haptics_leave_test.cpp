// SPDX-License-Identifier: GPL-3.0-or-later
// A tool that was moved and turned in a hole comes out of it when the hand draws it out along its axis.
#include <gtest/gtest.h>

#include "haptics_tools.h"

using namespace trephine;
using namespace trephine::tools;
using walls::uniform;

namespace {

constexpr double top_mm = 4;
constexpr const char* all_kinds[] = {"needle",   "catheter",   "burr", "craniotome", "jamshidi",
                                     "cylinder", "matchstick", "rod",  "round_burr"};

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
};

struct Left {
  double behind_mm = 0, force_n = 0;  ///< at the end: of the tool behind the device, and of the force
  bool was_locked = false;
  int ticks = 0, locked_ticks = 0;
  double off_line_mm = 0;  ///< at most, of a locked tip from the axis that it was locked on
  double step_n = 0;       ///< largest change of the force from tick to tick, where a lock begins or ends
};

// Into the hole, about in it at random, and out along the hand's axis to 13 mm above the rim.
Left leave(const Session& session, const contact::ContactVolume& contact) {
  std::mt19937_64 rng(session.seed);
  const haptics::ToolParams tool = params_of(session.kind, session.tool_diameter_mm, 24, 1);
  haptics::Proxy proxy(contact, one_shape(1, face(1, 0.35, 0.3), face(1, 0.35, 0.3)), plain(), {},
                       haptics::make_tool(tool));
  Left left;
  Vec3 tip{0, 0, top_mm + 6}, axis{0, 0, 1}, locked_at;
  haptics::HapticState before;
  const auto move = [&](Vec3 to_tip, Vec3 to_axis, int ticks) {
    const Vec3 from = tip, from_axis = axis;
    for (int n = 1; n <= ticks; ++n) {
      tip = from + (to_tip - from) * (double(n) / ticks);
      axis = normalized(from_axis + (to_axis - from_axis) * (double(n) / ticks));
      const haptics::HapticState& is = proxy.update(pose(tip, axis));
      left.was_locked = is.locked || left.was_locked;
      ++left.ticks;
      left.locked_ticks += is.locked;
      if (is.events & haptics::haptic_event::locked) locked_at = is.proxy_mm;
      if (is.locked) left.off_line_mm = std::max(left.off_line_mm, norm(cross(is.proxy_mm - locked_at, is.axis)));
      if (is.locked != before.locked) left.step_n = std::max(left.step_n, norm(is.force_n - before.force_n));
      before = is;
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
  double locked_percent = 0, off_line_mm = 0, mean_step_n = 0;
};

Outcome sessions(int count, std::uint64_t seed) {
  Outcome out;
  double ticks = 0, locked_ticks = 0;
  for (const double hole_radius_mm : {1.5, 2.5, 4.0}) {
    voxel::HapticVolume volume = block(hole_radius_mm);
    const contact::ContactVolume contact(volume);
    std::mt19937_64 rng(seed);
    for (int n = 0; n < count / 3; ++n) {
      const char* kind = all_kinds[rng() % std::size(all_kinds)];
      const Session session{kind, hole_radius_mm, uniform(rng, 0.5, 0.95) * 2 * hole_radius_mm, uniform(rng, 0.5, 8),
                            rng()};
      const Left left = leave(session, contact);
      out.locked += left.was_locked;
      out.mean_step_n += left.step_n;
      out.off_line_mm = std::max(out.off_line_mm, left.off_line_mm);
      ticks += left.ticks;
      locked_ticks += left.locked_ticks;
      if (!(left.behind_mm > 0.5) && !(left.force_n > 0.5)) continue;
      ++out.caught;
      std::printf("  caught: %s of %.2f mm in a hole of %.1f mm radius, seed %llu, %.1f mm behind, %.1f N\n", kind,
                  session.tool_diameter_mm, hole_radius_mm, static_cast<unsigned long long>(session.seed),
                  left.behind_mm, left.force_n);
    }
  }
  out.locked_percent = 100 * locked_ticks / ticks;
  out.mean_step_n /= std::max(1, out.locked);
  std::printf(
      "  %d of %d sessions locked, in %.1f %% of the ticks; %d were caught; locked tips left their line by at most "
      "%.3f mm; a lock that began or ended changed the force by at most %.2f N in the mean session\n",
      out.locked, count, out.locked_percent, out.caught, out.off_line_mm, out.mean_step_n);
  return out;
}

}  // namespace

TEST(HapticsLeave, AlongTheAxisAToolComesOut) {
  const Outcome is = sessions(300, 1);
  EXPECT_GT(is.locked, 20) << "else nothing was tried";
  EXPECT_EQ(is.caught, 0);
  EXPECT_GT(is.off_line_mm, 0.2) << "a locked tool moves on, but for its turn";
}

TEST(LongHapticsLeave, OfTenThousandSessionsNoneIsCaught) { EXPECT_EQ(sessions(10002, 7).caught, 0); }
