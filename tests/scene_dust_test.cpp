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

constexpr std::uint32_t command(int number) { return std::uint32_t(number) << haptics::belt_button::command_shift; }
constexpr std::uint32_t second = 1u << haptics::belt_button::tool_shift;

haptics::ServoFrame frame(std::uint32_t buttons, int touched = 0) {
  haptics::ServoFrame f;
  f.dt_s = 0.001;
  f.axis[2] = 1;
  f.buttons = buttons;
  f.touched = touched;
  return f;
}

// A lesson's belt of a thin burr and a wide one.
haptics::RecordingHeader belt() {
  haptics::RecordingHeader h = header(40);
  for (const double mm : {3.0, 7.0}) {
    haptics::BeltToolParams t;
    t.tool = t.name = "ball";
    t.tool_diameter_mm = mm;
    t.cuts = true;
    h.tools.push_back(t);
  }
  return h;
}

scene::DustWatch dusty(const haptics::RecordingHeader& h) {
  scene::DustWatch watch(std::make_shared<scene::BoneDust>(), h, bone);
  for (const haptics::ServoFrame& f : stroke({0, 0, 0})) watch.look(f);
  watch.look(frame(0));
  return watch;
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
  EXPECT_EQ(dust.texels().size(), 3u * 48 * 48 * 48);
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

// A ball of the volume that has come; what is more runs down; and no more comes once it is stopped.
TEST(BoneDust, BloodWellsUpAndIsStopped) {
  const Vec3 at{40, -30, 120}, down{0, 1, 0};
  scene::BoneDust dust;
  dust.bleed({{at, at, 0, 6, 4, 14}}, down);  // a hole without depth
  scene::BoneDust::Tick tick;
  const auto until = [&](double time_s) {
    for (; tick.time_s < time_s - 1e-9; tick.time_s += tick.dt_s) dust.add(tick);
  };
  const auto reach_mm = [&](Vec3 way) {
    double far = 0;
    while (dust.blood_at(at + way * far) > 0.5) far += 0.05;
    return far;
  };
  until(0.9);
  EXPECT_FALSE(dust.any()) << "before it happened";
  tick.runs = tick.cuts = true;  // dust lies elsewhere before it bleeds
  tick.tip_mm = at + Vec3{-6, 0, 0};
  dust.add(tick);
  tick.runs = tick.cuts = false;
  for (const double s : {6.0, 9.0, 14.0}) {
    until(s);
    const double radius_mm = std::cbrt(3e3 * 0.1 * (s - 4) / (4 * M_PI));
    EXPECT_NEAR(reach_mm({1, 0, 0}), radius_mm, 1.2 * scene::BoneDust::cell_mm) << s;
    EXPECT_NEAR(reach_mm({0, 0, -1}), radius_mm, 1.2 * scene::BoneDust::cell_mm) << s;
  }
  until(40);
  EXPECT_NEAR(reach_mm({1, 0, 0}), 6.2, 1.2 * scene::BoneDust::cell_mm) << "a millilitre, and no more";
  // A hole of 5 mm is filled from its bottom: 10 mm deep it holds 0.2 ml.
  scene::BoneDust hole;
  hole.bleed({{at, at + Vec3{0, 0, 10}, 5, 6, 0, 1e9}}, down);
  scene::BoneDust::Tick in_hole;
  for (; in_hole.time_s < 1; in_hole.time_s += 0.001) hole.add(in_hole);
  EXPECT_GT(hole.blood_at(at + Vec3{2, 0, 3}), 0.5);
  EXPECT_EQ(hole.blood_at(at + Vec3{0, 0, 10}), 0);
  for (; in_hole.time_s < 3; in_hole.time_s += 0.001) hole.add(in_hole);
  EXPECT_GT(hole.blood_at(at + Vec3{2, 0, 10}), 0.5);
  EXPECT_EQ(hole.blood_at(at + Vec3{5, 0, 5}), 0) << "not within the bone";
  // Once it is stopped and taken up, none comes again.
  hole.bleed({{at, at + Vec3{0, 0, 10}, 5, 6, 0, in_hole.time_s}}, down);
  in_hole.takes_up = true;
  in_hole.tip_mm = at;
  for (; in_hole.time_s < 5; in_hole.time_s += 0.001) hole.add(in_hole);
  in_hole.takes_up = false;
  for (; in_hole.time_s < 6; in_hole.time_s += 0.001) hole.add(in_hole);
  EXPECT_LT(hole.blood_at(at), 0.05);
  EXPECT_LT(hole.blood_at(at + Vec3{0, 0, 9}), 0.05);
  // A sinus fills more than a hole: the rest runs down.
  scene::BoneDust sinus;
  sinus.bleed({{at, at, 0, 60, 0, 1e9}}, down);
  for (int n = 0; n < 12000; ++n) sinus.add({0.001, 0.001 * n, false, false, false, {}, {0, 0, 1}, 2.5, 0});
  EXPECT_GT(sinus.blood_at(at + down * 15), 0.5);
  EXPECT_EQ(sinus.blood_at(at - down * 15), 0);
}

TEST(BoneDust, SuctionTakesBloodUpAndSalineThinsIt) {
  const Vec3 at{40, -30, 120};
  const auto after = [&](bool takes_up, double water, double more_s) {
    scene::BoneDust dust;
    dust.bleed({{at, at, 0, 6, 0, 1e9}}, {0, 1, 0});
    scene::BoneDust::Tick t;
    for (; t.time_s < 10; t.time_s += t.dt_s) dust.add(t);
    t.tip_mm = at;
    t.takes_up = takes_up;
    t.runs = water > 0;
    t.water_ml_per_min = water;
    for (; t.time_s < 12; t.time_s += t.dt_s) dust.add(t);
    t.takes_up = t.runs = false;
    for (; t.time_s < 12 + more_s; t.time_s += t.dt_s) dust.add(t);
    return dust.blood_at(at + Vec3{3, 0, 0});
  };
  EXPECT_GT(after(false, 0, 0), 0.9);
  EXPECT_LT(after(true, 0, 0), 0.1);
  EXPECT_LT(after(false, 120, 0), 0.3);
  EXPECT_GT(after(true, 0, 6), 0.9) << "it goes on bleeding";
}

// While the first hand does something else elsewhere, as far as the frames of both say it.
TEST(BoneDust, ASecondHandTakesUpWhatBleeds) {
  const Vec3 at{40, -30, 120};
  haptics::RecordingHeader header;
  header.tool.tool = "rod";
  header.second.emplace();
  header.second->tool.tool = header.second->tool.name = "suction";
  const auto after = [&](std::uint32_t buttons, std::uint32_t faults, double off_mm, int shape = 0) {
    auto dust = std::make_shared<scene::BoneDust>();
    scene::DustWatch watch(dust, header, 0, [&](Vec3) { return shape; });
    watch.bleed({{at, at, 0, 6, 0, 1e9}}, {0, 1, 0});
    haptics::ServoFrame first, second;
    for (int n = 0; n < 12000; ++n) {
      first.time_s = second.time_s = 0.001 * n;
      first.dt_s = second.dt_s = 0.001;
      for (int a = 0; a < 3; ++a) second.proxy_mm[a] = at[a] + (a == 1 ? off_mm : 0);
      first.axis[2] = second.axis[2] = 1;
      second.buttons = n < 10000 ? 0 : buttons;
      second.faults = faults;
      watch.look(first, true, &second);
    }
    return dust->blood_at(at + Vec3{3, 0, 0});
  };
  EXPECT_LT(after(1, 0, 0), 0.1);
  EXPECT_GT(after(0, 0, 0), 0.9) << "its switch is up";
  EXPECT_GT(after(1, haptics::haptic_fault::gap, 0), 0.9);
  EXPECT_GT(after(1, 0, 40), 0.9) << "elsewhere";
  EXPECT_GT(after(1 | haptics::haptic_button::lifted, 0, 0), 0.9);
  EXPECT_GT(after(1, 0, 0, 1), 0.9) << "it began in a shape and feels nothing";
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

// Where the drill takes nothing back, the hole stays, and the dust with it.
TEST(BoneDust, IsGoneWhereAllIsTakenBackAndOnlyThere) {
  using namespace haptics;
  const std::uint32_t reset = command(belt_command::reset);
  RecordingHeader one = header(40), none = one, no_drill = belt();
  none.drilling.undo_steps = 0;
  no_drill.drilling.drill = false;
  const auto stays = [&](const RecordingHeader& h, const std::vector<ServoFrame>& then) {
    scene::DustWatch watch(std::make_shared<scene::BoneDust>(), h, bone);
    scene::BoneDust::Tick tick;
    tick.runs = tick.cuts = true;
    for (int n = 0; n < 100; ++n) watch.dust()->add(tick);
    for (const ServoFrame& f : then) watch.look(f);
    return watch.dust()->any();
  };
  ServoFrame faulty = frame(reset);
  faulty.faults = 1;
  const ServoFrame pause = frame(command(belt_command::pause)), resume = frame(command(belt_command::resume));
  for (const RecordingHeader& h : {one, belt()}) {
    EXPECT_FALSE(stays(h, {frame(0), frame(reset)}));
    EXPECT_TRUE(stays(h, {frame(0), frame(Drilling::pedal | reset), frame(reset)})) << "the pedal was down";
    EXPECT_TRUE(stays(h, {frame(0), faulty}));
  }
  EXPECT_FALSE(stays(one, {frame(0), faulty, frame(reset)})) << "taken once the fault is over";
  EXPECT_TRUE(stays(none, {frame(0), frame(reset)})) << "nothing can be taken back";
  EXPECT_TRUE(stays(no_drill, {frame(0), frame(reset)})) << "this session drills nothing";
  EXPECT_TRUE(stays(belt(), {frame(0), pause, frame(0), frame(reset)})) << "in a pause";
  EXPECT_FALSE(stays(belt(), {frame(0), pause, frame(0), resume, frame(reset)}));
  EXPECT_FALSE(stays(belt(), {frame(0, 1), pause, frame(0), frame(reset)})) << "no pause where it touches";
  EXPECT_TRUE(stays(belt(), {frame(0), frame(haptic_button::lifted | reset)}));
}

// After a step was taken back a belt waits for a pose outside of every shape, and takes nothing until then.
TEST(BoneDust, AResetInTheWaitAfterAnUndoClearsNothing) {
  using namespace haptics;
  const auto stays = [&](const std::vector<ServoFrame>& then) {
    scene::DustWatch watch(std::make_shared<scene::BoneDust>(), belt(), bone, [](Vec3 p) { return p.z < 0 ? 1 : 0; });
    scene::BoneDust::Tick tick;
    tick.runs = tick.cuts = true;
    for (int n = 0; n < 100; ++n) watch.dust()->add(tick);
    for (const ServoFrame& f : then) watch.look(f);
    return watch.dust()->any();
  };
  const auto frame_at = [](double z, std::uint32_t buttons) {
    ServoFrame f = frame(buttons);
    f.tip_mm[2] = z;
    return f;
  };
  const std::uint32_t undo = command(belt_command::undo), reset = command(belt_command::reset);
  EXPECT_TRUE(stays({frame_at(5, 0), frame_at(5, undo), frame_at(-1, 0), frame_at(-1, reset)}));
  EXPECT_FALSE(stays({frame_at(5, 0), frame_at(5, undo), frame_at(-1, 0), frame_at(5, 0), frame_at(5, reset)}));
  EXPECT_TRUE(stays({frame_at(-1, 0), frame_at(-1, reset)})) << "it begins in a shape";
}

// Going back in a long recording is as cheap as what lies between two times that were kept, and gives the same.
TEST(BoneDust, GoingBackDoesNotBeginAnew) {
  std::vector<haptics::ServoFrame> frames;
  for (int n = 0; n < 60; ++n)
    for (const haptics::ServoFrame& f : stroke({0.1 * n, 0, 0})) frames.push_back(f);
  ASSERT_GT(frames.size(), 100000u);
  scene::DustWatch shown = watch_of(40);
  shown.go_to(frames, frames.size());
  const std::vector<std::uint8_t> end = shown.dust()->texels();
  for (const std::size_t count : {frames.size() - 10, frames.size() / 2, std::size_t{5000}, std::size_t{100}}) {
    const std::uint64_t version = shown.dust()->version();
    shown.go_to(frames, count);
    scene::DustWatch anew = watch_of(40);
    anew.go_to(frames, count);
    EXPECT_EQ(shown.dust()->texels(), anew.dust()->texels()) << count;
    EXPECT_NE(shown.dust()->version(), version) << "a picture is told";
    EXPECT_LT(shown.last_looked(), 20000u) << count;
  }
  shown.go_to(frames, frames.size());
  EXPECT_EQ(shown.dust()->texels(), end);
  EXPECT_LT(shown.last_looked(), 20000u) << "nor does going on";
}

TEST(BoneDust, AToolThatIsAwayWashesNothing) {
  for (const haptics::RecordingHeader& h : {header(40), belt()}) {
    scene::DustWatch watch = dusty(h);
    const std::vector<std::uint8_t> before = watch.dust()->texels();
    for (int n = 0; n < 200; ++n) watch.look(frame(haptics::Drilling::pedal | haptics::haptic_button::lifted));
    EXPECT_EQ(watch.dust()->texels(), before);
    for (int n = 0; n < 200; ++n) watch.look(frame(haptics::Drilling::pedal));
    EXPECT_NE(watch.dust()->texels(), before);
  }
}

TEST(BoneDust, IsThatOfTheToolInHandAndNotOfTheOneAskedFor) {
  const auto drilled_with = [](std::uint32_t begins, std::uint32_t asks) {
    scene::DustWatch watch(std::make_shared<scene::BoneDust>(), belt(), bone);
    watch.look(frame(begins));
    for (haptics::ServoFrame f : stroke({0, 0, 0})) {
      f.buttons |= asks;
      watch.look(f);
    }
    return watch.dust()->texels();
  };
  EXPECT_EQ(drilled_with(0, second), drilled_with(0, 0)) << "it is asked for while the first one touches";
  EXPECT_NE(drilled_with(second, second), drilled_with(0, 0)) << "taken in the open";
  EXPECT_EQ(drilled_with(0, 9 * second), drilled_with(0, 0)) << "there is no such tool";
}

// What is not seen costs nothing, and the hand is followed all the same.
TEST(BoneDust, NoneFallsWhileNoneIsShown) {
  scene::DustWatch watch(std::make_shared<scene::BoneDust>(), belt(), bone);
  watch.look(frame(second), false);
  for (const haptics::ServoFrame& f : stroke({0, 0, 0})) watch.look(f, false);
  EXPECT_FALSE(watch.dust()->any());
  for (haptics::ServoFrame f : stroke({0, 0, 0})) {
    f.buttons |= second;
    watch.look(f);
  }
  EXPECT_TRUE(watch.dust()->any());
  watch.look(frame(command(haptics::belt_command::reset)), false);
  EXPECT_FALSE(watch.dust()->any()) << "it does not come back with the view";
}
