// SPDX-License-Identifier: GPL-3.0-or-later
// Tips of tools, of poses with a known truth.
#include <gtest/gtest.h>

#include "base/error.h"
#include "track/pivot.h"
#include "track_fake.h"

using namespace track_fake;
using track::pivot_tip;
using track::PivotParams;
using track::PivotTip;

namespace {

/// Poses before the reference while the tip rests, the tool tilted to `tilt_deg` on all sides.
std::vector<RigidMap> tilted(const Theatre& t, int count, double tilt_deg, double noise_mm, Random& random) {
  std::vector<RigidMap> poses;
  for (int n = 0; n < count; ++n) {
    const double tilt = tilt_deg * pi / 180 * std::sin(0.11 * n), turn = 0.05 * n;
    const Vec3 axis{std::sin(tilt) * std::cos(turn), std::sin(tilt) * std::sin(turn), std::cos(tilt)};
    const RigidMap body = seen(t.body_at({5, 6, 7}, axis, 0.2 * std::sin(0.03 * n)), noise_mm, random);
    poses.push_back(then(body, inverse(seen(t.reference_to_tracker, noise_mm, random))));
  }
  return poses;
}
std::vector<RigidMap> spun(const Theatre& t, int count, double turn_deg, double noise_mm, Random& random) {
  std::vector<RigidMap> poses;
  for (int n = 0; n < count; ++n) {
    const Vec3 axis = normalized(Vec3{0.03 * std::sin(0.2 * n), 0.02 * std::cos(0.3 * n), 1});  // a hand wobbles
    const RigidMap body = t.body_at({5, 6, 7}, axis, turn_deg * pi / 180 * std::sin(0.04 * n));
    poses.push_back(then(seen(body, noise_mm, random), inverse(t.reference_to_tracker)));
  }
  return poses;
}
ExitCode code_of(const std::function<void()>& act) {
  try {
    act();
  } catch (const Error& e) {
    return e.code();
  }
  return ExitCode::ok;
}

TEST(TrackPivot, TheTipIsFoundExactly) {
  Random random(1);
  const Theatre t;
  const PivotTip tip = pivot_tip(tilted(t, 200, 30, 0, random), {});
  EXPECT_LT(norm(tip.tip_mm - t.tip_mm), 1e-6);
  EXPECT_LT(norm(tip.rest_mm - t.case_to_reference({5, 6, 7})), 1e-6);
  EXPECT_LT(tip.residual_mm, 1e-6);
  EXPECT_EQ(tip.outliers, 0u);
}

// The error that it states is that of many tries, and it grows with the tracker's noise.
TEST(TrackPivot, ItsErrorIsWhatItStates) {
  const Theatre t;
  double before = 0;
  for (const double noise : {0.1, 0.2, 0.3}) {
    double off = 0, stated = 0;
    constexpr int tries = 40;
    for (int n = 0; n < tries; ++n) {
      Random random{std::uint64_t(100 + n)};
      const PivotTip tip = pivot_tip(tilted(t, 400, 30, noise, random), {});
      off += dot(tip.tip_mm - t.tip_mm, tip.tip_mm - t.tip_mm) / tries;
      stated += tip.tip_error_mm * tip.tip_error_mm / tries;
    }
    off = std::sqrt(off), stated = std::sqrt(stated);
    std::cout << "pivot, noise " << noise << " mm: off " << off << ", stated " << stated << " mm\n";
    EXPECT_GT(stated, 0.6 * off);
    EXPECT_LT(stated, 1.7 * off);
    EXPECT_LT(off, 0.7 * noise);
    EXPECT_GT(off, before);
    before = off;
  }
}

TEST(TrackPivot, ASlipIsLeftOut) {
  const Theatre t;
  Random random(5);
  std::vector<RigidMap> poses = tilted(t, 400, 30, 0.1, random);
  const double without = norm(pivot_tip(poses, {}).tip_mm - t.tip_mm);
  for (int n = 130; n < 170; ++n) poses[std::size_t(n)].offset_mm += {4, -3, 6};
  const PivotTip tip = pivot_tip(poses, {});
  EXPECT_GE(tip.outliers, 40u);
  EXPECT_LT(tip.outliers, 60u);
  EXPECT_LT(norm(tip.tip_mm - t.tip_mm), without + 0.1);
  EXPECT_LT(tip.residual_mm, 0.5);
  for (int n = 0; n < 45; ++n) poses[std::size_t(n)].offset_mm += {300, -200, 100};  // it was on its way there
  EXPECT_LT(norm(pivot_tip(poses, {}).tip_mm - t.tip_mm), without + 0.1);
}

TEST(TrackPivot, ANarrowConeASlidingTipAndFewPosesAreRefused) {
  const Theatre t;
  Random random(7);
  EXPECT_EQ(code_of([&] { pivot_tip(tilted(t, 400, 8, 0.1, random), {}); }), ExitCode::quality);
  EXPECT_EQ(code_of([&] { pivot_tip(spun(t, 400, 170, 0.1, random), {}); }), ExitCode::quality) << "only turned";
  EXPECT_EQ(code_of([&] { pivot_tip(tilted(t, 39, 30, 0.1, random), {}); }), ExitCode::quality);
  std::vector<RigidMap> sliding = tilted(t, 400, 30, 0.1, random);
  for (std::size_t n = 0; n < sliding.size(); ++n) sliding[n].offset_mm += Vec3{0.05, 0.03, 0} * double(n);
  EXPECT_EQ(code_of([&] { pivot_tip(sliding, {}); }), ExitCode::quality);
  EXPECT_EQ(code_of([&] { pivot_tip(tilted(t, 400, 30, 0.1, random), {}); }), ExitCode::ok);
}

TEST(TrackPivot, TheAxisIsThatOfTheTurn) {
  Theatre below, above;  // of the tip the body lies where the tail is
  above.tip_mm = {3, -2, 151};
  above.axis = -above.axis;
  for (const Theatre& t : {below, above})
    for (const double noise : {0.0, 0.3}) {
      Random random(9);
      const Vec3 axis = track::spin_axis(spun(t, 200, 100, noise, random), t.tip_mm);
      EXPECT_NEAR(norm(axis), 1, 1e-9);
      EXPECT_LT(std::acos(std::min(1.0, dot(axis, t.axis))) * 180 / pi, 0.5) << noise;  // with its sign: to the tail
    }
  Random random(9);
  EXPECT_EQ(code_of([&] { track::spin_axis(tilted(below, 200, 30, 0, random), below.tip_mm); }), ExitCode::quality);
  EXPECT_EQ(code_of([&] { track::spin_axis(spun(below, 200, 10, 0, random), below.tip_mm); }), ExitCode::quality);
}

}  // namespace
