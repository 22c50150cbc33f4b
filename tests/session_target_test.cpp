// SPDX-License-Identifier: GPL-3.0-or-later
// A target that runs over the surface, and hands that follow it [Rizzi, figure 10].
#include <gtest/gtest.h>

#include <cmath>

#include "device/hand_path.h"
#include "device/simulated_hand.h"
#include "haptics/recording.h"
#include "haptics_tools.h"
#include "json/declared_json.h"
#include "session/moving_target.h"

using namespace trephine;
using namespace trephine::tools;

namespace {

constexpr double radius_mm = 6, ball_mm = 12, begins_s = 0.5;

// A ball of bone, and how it is felt.
struct Ground {
  voxel::HapticVolume volume = empty(60, {0.5, 0.5, 0.5});
  std::unique_ptr<contact::ContactVolume> contact;
  haptics::Feels feels = one_shape(1, face(0.5, 0, 0), face(0.5, 0, 0));
  Ground() {
    fill_wide(volume, 1, [](Vec3 p) { return ball_mm - norm(p); });
    contact = std::make_unique<contact::ContactVolume>(volume);
  }
  session::MovingTarget target(haptics::TargetParams p) const {
    return session::MovingTarget(p, *contact, haptics::touchable_of(feels));
  }
};

haptics::TargetParams circle(double speed = 8, double begins = begins_s) {
  haptics::TargetParams p;
  p.target = true;
  p.target_speed_mm_per_s = speed;
  p.target_radius_mm = radius_mm;
  p.target_begins_s = begins;
  return p;
}

// A simulated hand on the target's path, from its begin on, with that delay.
std::vector<haptics::ServoFrame> followed(const Ground& ground, const session::MovingTarget& target, double delay_s,
                                          double seconds) {
  haptics::Proxy proxy(*ground.contact, ground.feels, haptics::ForceParams{});
  device::HandParams params;
  params.tremor_mm = 0;
  params.delay_s = delay_s;
  params.speed_mm_per_s = target.speed_mm_per_s();
  std::vector<Vec3> path;
  constexpr int places = 600;
  const double round_s = target.round_mm() / target.speed_mm_per_s();
  for (int n = 0; n <= places; ++n) path.push_back(target.at_mm(begins_s + round_s * n / places));
  path.back() = path.front();
  device::SimulatedHand hand(params, path);
  std::vector<haptics::ServoFrame> frames;
  for (int n = 0; n < int(1000 * seconds); ++n) {
    device::DeviceReading reading;
    hand.read(0.001, reading);
    haptics::HapticInput in = pose(reading.tip_mm, {0, 0, 1});
    const haptics::HapticState& s = proxy.update(in);
    hand.send(s.force_n);
    haptics::ServoFrame f;
    f.tick = std::uint64_t(n);
    f.time_s = begins_s + 0.001 * (n + 1);
    f.dt_s = 0.001;
    haptics::put_input(in, f);
    haptics::put_answer(s, f);
    frames.push_back(f);
  }
  return frames;
}

session::TargetFigures figures(const session::MovingTarget& target, const std::vector<haptics::ServoFrame>& frames) {
  session::TargetWatch watch(std::make_shared<const session::MovingTarget>(target));
  for (const haptics::ServoFrame& f : frames) watch.look(f);
  return watch.figures();
}

}  // namespace

TEST(MovingTarget, RunsOverTheSurfaceAtItsSpeed) {
  const Ground ground;
  const session::MovingTarget target = ground.target(circle());
  EXPECT_NEAR(target.round_mm(), 2 * M_PI * radius_mm, 0.2);
  EXPECT_FALSE(target.runs(0.49));
  EXPECT_EQ(norm(target.at_mm(0.2) - target.first_mm()), 0);
  for (double t = 0.5; t < 12; t += 0.37) {
    const Vec3 at = target.at_mm(t);
    EXPECT_NEAR(norm(at), ball_mm, 0.05) << "on the surface";
    EXPECT_NEAR(std::hypot(at.x, at.y), radius_mm, 0.02);
    EXPECT_NEAR(norm(target.at_mm(t + 0.01) - at), 0.08, 0.003) << "at its speed";
    EXPECT_NEAR(target.behind_mm(t, at), 0, 1e-6);
    EXPECT_NEAR(target.behind_mm(t, target.at_mm(t - 0.25)), t >= 0.75 ? 2 : 8 * (t - 0.5), 0.02);
    EXPECT_NEAR(target.behind_mm(t, target.at_mm(t + 0.25)), -2, 0.02) << "ahead";
  }
  // Around again.
  const double round_s = target.round_mm() / 8;
  EXPECT_NEAR(norm(target.at_mm(1 + round_s) - target.at_mm(1)), 0, 1e-9);
}

// What is reported is the hand's delay, and the lag of the mass on its spring, which is the same for both.
TEST(MovingTarget, AHandThatIsLateIsBehindByItsDelay) {
  const Ground ground;
  const session::MovingTarget target = ground.target(circle());
  const session::TargetFigures soon = figures(target, followed(ground, target, 0.05, 6)),
                               late = figures(target, followed(ground, target, 0.35, 6));
  EXPECT_NEAR(soon.seconds, 6, 0.01);
  EXPECT_NEAR(late.mean_behind_mm - soon.mean_behind_mm, 0.3 * 8, 0.25);
  EXPECT_NEAR(late.mean_behind_s, late.mean_behind_mm / 8, 1e-9);
  EXPECT_GT(soon.mean_behind_mm, 0.2);
  EXPECT_LT(soon.mean_behind_mm, 1);
  EXPECT_GE(late.most_off_mm, late.p95_off_mm);
  EXPECT_NEAR(late.mean_off_mm, late.mean_behind_mm, 0.4) << "it keeps to the path";
  EXPECT_NE(session::target_text(late).find("behind by"), std::string::npos);
  // A session that ended before the target set off says nothing.
  EXPECT_EQ(session::target_text(figures(ground.target(circle(8, 60)), followed(ground, target, 0.1, 0.4))), "");
}

TEST(MovingTarget, TheHeaderKeepsIt) {
  haptics::RecordingHeader h;
  const std::string without = json::declared_json(parameters_of<haptics::RecordingHeader>(), &h);
  EXPECT_EQ(without.find("target"), std::string::npos);
  h.target = circle(12.5, 2);
  const std::string with = json::declared_json(parameters_of<haptics::RecordingHeader>(), &h);
  haptics::RecordingHeader again;
  json::JsonRules rules;
  rules.by_program = true;
  json::read_declared_json(with, parameters_of<haptics::RecordingHeader>(), &again, rules);
  EXPECT_TRUE(again.target.target);
  EXPECT_EQ(again.target.target_speed_mm_per_s, 12.5);
  EXPECT_EQ(again.target.target_begins_s, 2);
  EXPECT_EQ(again.target.target_radius_mm, radius_mm);
}
