// SPDX-License-Identifier: GPL-3.0-or-later
// What is felt everywhere, against what it is by its formulas: viscosity, weight, guides.
#include <gtest/gtest.h>

#include "base/error.h"
#include "haptics/device_port.h"
#include "haptics/recording.h"
#include "haptics_scene.h"

using namespace trephine;
using namespace trephine::haptic_scenes;
using haptics::FreeParams;

namespace {

struct Air {
  voxel::HapticVolume volume = empty(24, {2, 2, 2});
  contact::ContactVolume contact;
  haptics::Proxy proxy;
  haptics::DevicePort port;
  static voxel::HapticVolume& filled(voxel::HapticVolume& v) {
    fill(v, 1, [](Vec3 p) { return -p.z; });
    return v;
  }
  explicit Air(const FreeParams& free, const haptics::ForceParams& limits = plain())
      : contact(filled(volume)),
        proxy(contact, one_shape(1, face(0.5), face(0.5)), limits),
        port(haptics::PortParams{}, limits, free) {}
  Vec3 feel(Vec3 tip, double dt_s = 0.001) {
    haptics::HapticInput in = at(tip, dt_s);
    port.before(in, false);
    return port.after(in, proxy.update(in)).force_n;
  }
};

void expect_near(Vec3 a, Vec3 b) { EXPECT_LT(norm(a - b), 1e-9) << a.x << " " << a.y << " " << a.z; }

}  // namespace

TEST(HapticsFree, ViscosityIsAgainstTheMotion) {
  FreeParams p;
  p.viscosity_n_s_per_mm = 0.004;
  Air air(p);
  expect_near(air.feel({0, 0, 10}), {});
  for (int n = 1; n < 20; ++n) expect_near(air.feel({0.05 * n, -0.1 * n, 10}), {-0.2, 0.4, 0});  // 50 and 100 mm/s
  expect_near(air.feel({0.95, -1.9, 10}), {});
  expect_near(air.feel({1.05, -1.9, 10}, 0.002), {-0.2, 0, 0});
}

TEST(HapticsFree, TheWeightIsHeldAlsoInContact) {
  FreeParams p;
  p.weight_n = {0.1, 0, -0.8};
  Air air(p), without{FreeParams{}};
  for (int n = 0; n < 50; ++n) {
    const Vec3 tip{0, 0, 1 - 0.04 * n};
    expect_near(air.feel(tip) - without.feel(tip), {-0.1, 0, 0.8});
  }
  EXPECT_GT(norm(without.feel({0, 0, -1})), 0.4);
}

TEST(HapticsFree, GuidesLeadToTheLineAndToThePlane) {
  FreeParams p;
  p.guide_point_mm = {1, 2, 10};
  p.guide_along = {0, 0, 0.5};
  p.guide = FreeParams::Guide::line;
  Air line(p);
  expect_near(line.feel({1, 2, 15}), {});
  expect_near(line.feel({2, 2, 5}), {-0.3, 0, 0});
  expect_near(line.feel({2, 0, 5}), {-0.3, 0.6, 0});
  expect_near(line.feel({1, 12, 5}), {0, -1, 0});  // 3 N, of which the guide gives 1
  p.guide = FreeParams::Guide::plane;
  Air plane(p);
  expect_near(plane.feel({-5, 7, 10}), {});
  expect_near(plane.feel({-5, 7, 12}), {0, 0, -0.6});
  expect_near(plane.feel({-5, 7, 9}), {0, 0, 0.3});
  p.guide_along = {0, 0, 0};
  EXPECT_THROW(Air{p}, Error);
}

// The limits of the device hold for it, and it is recorded.
TEST(HapticsFree, ItKeepsTheLimitsAndReplays) {
  FreeParams p;
  p.weight_n = {0, 0, -30};
  p.guide = FreeParams::Guide::line;
  p.viscosity_n_s_per_mm = 0.01;
  haptics::ForceParams limits;
  Air air(p, limits), again(p, limits), other{FreeParams{}, limits};
  std::vector<haptics::ServoFrame> frames;
  for (int n = 0; n < 1000; ++n) {
    haptics::ServoFrame f;
    f.tick = std::uint64_t(n);
    f.dt_s = 0.001;
    f.axis[2] = 1;
    f.tip_mm[0] = 5 * std::sin(0.01 * n);
    f.tip_mm[2] = 5 * std::cos(0.02 * n);
    frames.push_back(f);
  }
  frames = haptics::replay_frames(frames, 1000, air.proxy, nullptr, &air.port);
  double most = 0, before = 0;
  for (const haptics::ServoFrame& f : frames) {
    const double force = norm(Vec3{f.force_n[0], f.force_n[1], f.force_n[2]});
    EXPECT_LE(force, limits.max_force_n + 1e-9);
    EXPECT_LE(std::abs(force - before), 1e-3 * limits.force_rate_n_per_s() + 1e-9);
    most = std::max(most, before = force);
  }
  EXPECT_GT(most, 0.99 * limits.max_force_n);
  const auto same = haptics::replay_frames(frames, 1000, again.proxy, nullptr, &again.port);
  for (std::size_t n = 0; n < frames.size(); ++n) ASSERT_TRUE(haptics::same_frame(frames[n], same[n])) << n;
  EXPECT_FALSE(haptics::same_frame(frames.back(),
                                   haptics::replay_frames(frames, 1000, other.proxy, nullptr, &other.port).back()));
}
