// SPDX-License-Identifier: GPL-3.0-or-later
// A cutter removes what lies on its way, however fast it goes: late where a tick has no time for it, never not at all.
#include <gtest/gtest.h>

#include "drill_scene.h"

using namespace trephine;
using namespace trephine::drilling;

namespace {

struct Swept {
  double removed_mm3 = 0, late_mm3 = 0;
  int ticks_after = 0;          ///< after the tool stood still, until nothing was late any more
  std::int64_t max_a_call = 0;  ///< units
};

// A groove of 20 mm along a face of the block, half a ball deep, then the tool is lifted.
Swept sweep(double radius_mm, double voxel_mm, double m_per_s, double dt_s, double power_w = 1e5, Vec3 beside_mm = {}) {
  const int n = int(44 / voxel_mm);
  voxel::HapticVolume volume = full(n, voxel_mm);
  drill::DrillParams law;
  law.power_w = power_w;
  law.max_rate_per_s = 10000;
  drill::Drill d(volume, only(1, 0.1), ball(radius_mm), law);
  const Vec3 x = volume.voxels.direction.column[0], from = middle(volume) - x * 10 + beside_mm;
  Swept out;
  const auto count = [&](const drill::Removal& r) {
    out.removed_mm3 += mm3(volume, r.units[1]);
    out.late_mm3 += mm3(volume, r.late_units);
    out.max_a_call = std::max(out.max_a_call, r.units[1]);
  };
  const double step_mm = 1000 * m_per_s * dt_s;
  for (int tick = 0;; ++tick) {
    const double at = std::min(20.0, step_mm * tick);
    const drill::ToolPose pose = centred(from + x * at, radius_mm);
    count(cut(d, pose, dt_s));
    if (at >= 20) break;
  }
  d.rest();
  for (; d.late() && out.ticks_after < 10000; ++out.ticks_after) count(d.cut_late(dt_s));
  return out;
}

double capsule_mm3(double radius_mm) {
  return M_PI * radius_mm * radius_mm * 20 + 4.0 / 3 * M_PI * radius_mm * radius_mm * radius_mm;
}

}  // namespace

TEST(DrillWay, HoweverFastTheToolGoes) {
  for (const double voxel_mm : {0.4, 0.8})
    for (const double radius_mm : {2.0, 7.0}) {
      const Swept slow = sweep(radius_mm, voxel_mm, 0.02, 0.001);
      // The ramp to each side of a round surface holds a little more outside than inside.
      EXPECT_NEAR(slow.removed_mm3 / capsule_mm3(radius_mm), 1, 0.03);
      for (const double m_per_s : {0.05, 0.5, 1.5, 3.0})
        for (const double dt_s : {0.001, 0.004, 0.021}) {
          SCOPED_TRACE(testing::Message()
                       << radius_mm << " mm, voxels " << voxel_mm << ", " << m_per_s << " m/s, " << dt_s << " s");
          const Swept is = sweep(radius_mm, voxel_mm, m_per_s, dt_s);
          EXPECT_NEAR(is.removed_mm3 / slow.removed_mm3, 1, 0.015);
          EXPECT_LE(is.max_a_call, std::int64_t(17000) * 255) << "a call is bounded";
        }
    }
}

// Balls of five voxels and more; of three and of two and a half, as docs/validation/drilling.md has it.
TEST(DrillWay, RemovesWhatItsBallSweeps) {
  for (const double voxels : {5.0, 6.0, 7.0, 8.5, 10.0, 3.0, 2.5}) {
    const double radius_mm = 0.4 * voxels;
    double least = 9, most = 0;
    for (const Vec3 beside_mm : {Vec3{}, Vec3{0.1, 0.2, 0.3}, Vec3{0.3, 0.1, -0.2}, Vec3{0, 0.4, 0.1}}) {
      const double is = sweep(radius_mm, 0.8, 0.02, 0.001, 1e5, beside_mm).removed_mm3 / capsule_mm3(radius_mm);
      least = std::min(least, is);
      most = std::max(most, is);
    }
    std::printf("  %.1f voxels: %.3f to %.3f\n", voxels, least, most);
    EXPECT_GT(least, 0.97) << voxels << " voxels";
    EXPECT_LT(most, voxels >= 5 ? 1.03 : voxels >= 3 ? 1.05 : 1.1) << voxels << " voxels";
  }
}

// A large cutter in fine voxels: what a fast tool leaves is removed behind it, and counted.
TEST(DrillWay, WhatIsLateIsCounted) {
  const Swept slow = sweep(7, 0.4, 0.01, 0.001), fast = sweep(7, 0.4, 3, 0.001);
  std::printf("  10 mm/s: %.1f of %.0f mm3 late; 3 m/s: %.1f of %.0f, for %d ticks after\n", slow.late_mm3,
              slow.removed_mm3, fast.late_mm3, fast.removed_mm3, fast.ticks_after);
  EXPECT_LT(slow.late_mm3, 0.05 * slow.removed_mm3);
  EXPECT_GT(fast.late_mm3, 0.2 * fast.removed_mm3);
  EXPECT_GT(fast.ticks_after, 3);
  EXPECT_LT(fast.ticks_after, 100);
}

// The power of all ticks together is what may be used, also where they are removed as one way.
TEST(DrillWay, UsesNoMorePowerThanItsTicksHad) {
  for (const double m_per_s : {0.05, 1.5}) {
    const double dt_s = 0.001, seconds = 0.02 / m_per_s + dt_s;
    const Swept is = sweep(7, 0.4, m_per_s, dt_s, 300);
    EXPECT_LE(0.1 * is.removed_mm3, 300 * (seconds + dt_s) * 1.02) << m_per_s;
    EXPECT_GE(0.1 * is.removed_mm3, 0.7 * std::min(300 * seconds, 0.1 * capsule_mm3(7))) << m_per_s;
  }
}

// Cutters that are changed while the queue of late ways is full: each way is cut with the cutter that went it. A wide
// ball leaves 32 ways waiting in the block's middle; a thin one and a third, as thin, then run 6 mm beside them.
TEST(DrillWay, LateWaysOfSeveralCuttersKeepTheirOwn) {
  voxel::HapticVolume volume = full(100, 0.4);
  drill::DrillParams law;
  law.power_w = 1e5;
  law.max_rate_per_s = 10000;
  drill::Drill d(volume, only(1, 0.1), ball(7), law);
  d.add_cutter(ball(1));
  d.add_cutter(ball(1.5));
  const Vec3 x = volume.voxels.direction.column[0], y = volume.voxels.direction.column[1], from = middle(volume);
  const auto go = [&](Vec3 at, double radius_mm) {
    const drill::ToolPose pose = centred(at, radius_mm);
    cut(d, pose, 0.001);
  };
  for (int n = 0; n < 400; ++n) go(from - y * 8 + x * (n % 2 == 0 ? -4.0 : 4.0), 7);  // to and fro: no ways are joined
  const Vec3 thin = from + y * 13;
  d.hold(1);
  go(thin, 1);
  d.hold(2);
  go(thin + x * 8, 1.5);
  for (int n = 0; d.late() && n < 100000; ++n) d.cut_late(0.001);
  ASSERT_FALSE(d.late());
  const auto stays = [&](Vec3 at) {
    const Vec3 i = volume.voxels.to_index(at);
    const auto near = [](double v) { return int(std::lround(v)); };
    return volume.voxels.at(near(i.x), near(i.y), near(i.z)) == 1255;
  };
  EXPECT_FALSE(stays(from - y * 8)) << "the wide ball's own way";
  EXPECT_FALSE(stays(thin)) << "the second cutter's";
  EXPECT_FALSE(stays(thin + x * 8)) << "the third cutter's";
  EXPECT_TRUE(stays(from + y * 5)) << "between them, where no cutter was";
  EXPECT_TRUE(stays(thin - y * 4)) << "as far as the wide ball alone would reach from the second cutter's way";
}

// A cutter that is changed with each way leaves no two that could be made one: all are cut all the same.
TEST(DrillWay, ACutterChangedWithEachWayLosesNone) {
  voxel::HapticVolume volume = full(200, 0.4);
  drill::DrillParams law;
  law.power_w = 1e6;
  law.max_rate_per_s = 10000;
  drill::Drill d(volume, only(1, 0.1), ball(6), law);
  d.add_cutter(ball(5));
  const Mat3& along = volume.voxels.direction;
  const auto place = [&](int n) {  // of a ball, apart from all others
    return middle(volume) + along.column[0] * (13.0 * (n % 5 - 2)) + along.column[1] * (13.0 * (n / 5 % 5 - 2)) +
           along.column[2] * (13.0 * (n / 25 - 1.5));
  };
  for (int n = 0; n < 100; ++n) {
    d.hold(n % 2);
    const drill::ToolPose pose = centred(place(n), n % 2 == 0 ? 6 : 5);
    cut(d, pose, 0.001);
  }
  for (int n = 0; d.late() && n < 100000; ++n) d.cut_late(0.001);
  ASSERT_FALSE(d.late());
  for (int n = 0; n < 100; ++n) {
    const Vec3 i = volume.voxels.to_index(place(n));
    const auto near = [](double v) { return int(std::lround(v)); };
    EXPECT_NE(volume.voxels.at(near(i.x), near(i.y), near(i.z)), 1255) << n;
  }
}
