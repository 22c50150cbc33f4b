// SPDX-License-Identifier: GPL-3.0-or-later
// Bone dust and saline, as they are seen where a drill works: a function of the frames, and nothing else.
#include <gtest/gtest.h>

#include "scene/bone_dust.h"

using namespace trephine;

namespace {

haptics::RecordingHeader header(double water_ml_per_min) {
  haptics::RecordingHeader h;
  h.tool.tool = "ball";
  h.tool.tool_diameter_mm = 5;
  h.drilling.drill = true;
  h.drilling.irrigation_ml_per_min = water_ml_per_min;
  return h;
}

constexpr std::uint64_t bone = 1 << 1;

// Two seconds of drilling at a place, then half a second in the air with the pedal up.
std::vector<haptics::ServoFrame> stroke(Vec3 at, int touched = 1) {
  std::vector<haptics::ServoFrame> frames;
  for (int n = 0; n < 2500; ++n) {
    haptics::ServoFrame f;
    f.tick = std::uint64_t(n);
    f.dt_s = 0.001;
    f.time_s = 0.001 * (n + 1);
    for (int a = 0; a < 3; ++a) f.proxy_mm[a] = at[a] - (a == 2 ? 0.001 * n : 0);
    f.axis[2] = 1;
    f.buttons = n < 2000 ? haptics::Drilling::pedal : 0;
    f.touched = touched;
    frames.push_back(f);
  }
  return frames;
}

scene::DustWatch watch_of(double water, std::uint64_t drilled = bone) {
  return {std::make_shared<scene::BoneDust>(), header(water), drilled};
}

// In the ring about a drill of 5 mm, a little above its tip.
double about(const scene::BoneDust& dust, Vec3 at, double (scene::BoneDust::*what)(Vec3) const) {
  double sum = 0;
  for (int n = 0; n < 36; ++n)
    sum += (dust.*what)(at + Vec3{2.6 * std::cos(n * M_PI / 18), 2.6 * std::sin(n * M_PI / 18), 2}) / 36;
  return sum;
}

}  // namespace

TEST(BoneDust, LiesWhereItWasDrilledDry) {
  const Vec3 at{40, -30, 120};
  scene::DustWatch watch = watch_of(0);
  for (const haptics::ServoFrame& f : stroke(at)) watch.look(f);
  const scene::BoneDust& dust = *watch.dust();
  EXPECT_GT(about(dust, at, &scene::BoneDust::dust_at), 0.5);
  EXPECT_EQ(about(dust, at, &scene::BoneDust::water_at), 0);
  EXPECT_EQ(dust.dust_at(at + Vec3{12, 0, 0}), 0) << "far from the drill";
  EXPECT_EQ(dust.texels().size(), 2u * 48 * 48 * 48);
}

TEST(BoneDust, SalineWashesItAway) {
  const Vec3 at{40, -30, 120};
  double dry = 0;
  for (const double water : {0.0, 40.0, 120.0}) {
    scene::DustWatch watch = watch_of(water);
    for (const haptics::ServoFrame& f : stroke(at)) watch.look(f);
    const double lies = about(*watch.dust(), at, &scene::BoneDust::dust_at);
    if (water == 0) {
      dry = lies;
      continue;
    }
    EXPECT_LT(lies, (water > 40 ? 0.3 : 0.7) * dry) << water;
    EXPECT_GT(about(*watch.dust(), at, &scene::BoneDust::water_at), 0.8) << water;
  }
}

TEST(BoneDust, OnlyADrillOnWhatItRemovesMakesIt) {
  for (const auto& [drilled, touched] : {std::pair{bone, 2}, {bone, 0}, {std::uint64_t{0}, 1}}) {
    scene::DustWatch watch = watch_of(0, drilled);
    for (const haptics::ServoFrame& f : stroke({0, 0, 0}, touched)) watch.look(f);
    EXPECT_FALSE(watch.dust()->any());
  }
}

// The same frames give the same cells, whether they come one by one or the recording is shown from another time.
TEST(BoneDust, ARecordingShowsTheSame) {
  std::vector<haptics::ServoFrame> frames = stroke({0, 0, 0});
  for (haptics::ServoFrame f : stroke({14, 3, 1})) {  // beyond where the cells were
    f.tick += 2500;
    f.time_s += 2.5;
    frames.push_back(f);
  }
  scene::DustWatch live = watch_of(40), shown = watch_of(40);
  for (const haptics::ServoFrame& f : frames) live.look(f);
  shown.go_to(frames, frames.size());
  EXPECT_EQ(live.dust()->texels(), shown.dust()->texels());
  const std::vector<std::uint8_t> end = shown.dust()->texels();
  shown.go_to(frames, 1200);
  EXPECT_NE(shown.dust()->texels(), end);
  shown.go_to(frames, frames.size());
  EXPECT_EQ(shown.dust()->texels(), end);
  EXPECT_GT(shown.dust()->dust_at({16.6, 3, 3}), 0) << "the cells went along";
  // What was taken back all at once left no dust.
  haptics::ServoFrame reset;
  reset.dt_s = 0.001;
  reset.buttons = std::uint32_t(haptics::belt_command::reset) << haptics::belt_button::command_shift;
  scene::DustWatch gone = watch_of(40);
  for (const haptics::ServoFrame& f : frames) gone.look(f);
  gone.look(reset);
  EXPECT_FALSE(gone.dust()->any());
}
