// SPDX-License-Identifier: GPL-3.0-or-later
// The force of a running drill: continuous, but for a pop or a breach, which have a time and a shape.
#include <gtest/gtest.h>

#include <numeric>

#include "haptics/force_slew.h"
#include "haptics/recording.h"
#include "haptics_tools.h"
#include "session/force_changes.h"

using namespace trephine;
using namespace trephine::tools;

namespace {

std::vector<double> followed(haptics::ForceParams::Shape shape, bool event, double event_s = 0.01) {
  haptics::ForceParams p;
  p.event_shape = shape;
  p.event_s = event_s;
  haptics::ForceSlew slew(p);
  std::vector<double> out;
  for (int n = 0; n < 60; ++n)
    out.push_back(slew.follow({0, 0, n < 10 ? 1.0 : 0.2}, true, event && n == 10, 0, 0.001).z);
  return out;
}

double most_step(const std::vector<double>& force) {
  double most = 0;
  for (std::size_t n = 1; n < force.size(); ++n) most = std::max(most, std::abs(force[n] - force[n - 1]));
  return most;
}

// Bone with an uneven floor on a dura.
voxel::HapticVolume floor_of_bone() {
  voxel::HapticVolume v = empty(56, {0.4, 0.4, 0.4});
  fill(v, 1, [](Vec3 p) { return 0.5 * std::min(-p.z, p.z + 3 + 0.3 * std::sin(2 * p.x) * std::cos(2 * p.y)); });
  fill(v, 2, [](Vec3 p) {
    const double under = -3 - 0.3 * std::sin(2 * p.x) * std::cos(2 * p.y);
    return 0.5 * std::min(under - p.z, p.z - under + 1);
  });
  return v;
}

struct Drilled {
  session::ForceChanges changes;
  int breaches = 0;
  bool breached = false;
};

Drilled through() {
  voxel::HapticVolume volume = floor_of_bone();
  contact::ContactVolume contact(volume);
  haptics::Feels feels = untouchable();
  feels[1].front = feels[1].back = face(1, 0.35, 0.3, 0, 0.0003);
  feels[2].front = face(0.3, 0.3, 0.25, 0, 0.0002);
  drill::DrillShapes shapes;
  shapes[1] = {true, 0.1};
  haptics::DrillingParams params;
  params.drill = true;
  const haptics::ToolParams tool = haptics::own_tool(params_of("ball", 5));
  drill::DrillParams law_of_removal;
  law_of_removal.power_w = 5;
  haptics::Drilling drilling(volume, contact, shapes, params, law_of_removal, haptics::cutter_of(params, tool));
  haptics::Proxy proxy(contact, feels, {}, {}, haptics::make_tool(tool));
  Drilled out;
  std::vector<haptics::ServoFrame> frames;
  for (int n = 0; n < 9000; ++n) {
    const double t = 0.001 * n;
    haptics::HapticInput in = pose({2.5 * std::cos(3 * t), 2.5 * std::sin(3 * t), 1 - 0.55 * t}, {0, 0, 1});
    in.buttons = haptics::Drilling::pedal;
    drilling.prepare(in);
    const haptics::HapticState is = proxy.update(in);
    drilling.tick(in, is);
    haptics::ServoFrame f;
    haptics::put_input(in, f);
    haptics::put_answer(is, f);
    f.dt_s = 0.001;
    frames.push_back(f);
    out.breaches += (is.events & haptics::haptic_event::breach) != 0;
  }
  out.changes = session::force_changes(frames, true);
  out.breached = drilling.outcome().breached;
  return out;
}

}  // namespace

TEST(HapticsSlew, AJumpIsAWayOfManyTicks) {
  const std::vector<double> is = followed(haptics::ForceParams::Shape::cosine, false);
  EXPECT_LT(most_step(is), 0.1);
  EXPECT_NEAR(is.back(), 0.2, 1e-12);
  EXPECT_NEAR(is[14], 1 - 5 * haptics::ForceSlew::max_n_per_ms, 1e-12);
}

TEST(HapticsSlew, AnEventHasItsTimeAndShape) {
  using Shape = haptics::ForceParams::Shape;
  for (const double event_s : {0.005, 0.01, 0.02})
    for (const Shape shape : {Shape::cosine, Shape::line, Shape::snap}) {
      const std::vector<double> is = followed(shape, true, event_s);
      const std::size_t ticks = std::size_t(1000 * event_s + 0.5);
      EXPECT_GT(is[10 + ticks - 2], 0.2 + 1e-5);
      EXPECT_NEAR(is[10 + ticks], 0.2, 1e-9) << event_s;
    }
  EXPECT_NEAR(most_step(followed(Shape::line, true)), 0.08, 1e-9);
  EXPECT_NEAR(most_step(followed(Shape::cosine, true)), 0.08 * M_PI / 2, 0.01);
  EXPECT_GT(most_step(followed(Shape::snap, true)), 0.2);
}

// Where nothing is drilled forces are as they were; a hand that takes its tool back is not pushed by a force that
// stays.
TEST(HapticsSlew, OnlyADrillIsHeldBack) {
  haptics::ForceParams p;
  haptics::ForceSlew slew(p);
  slew.follow({0, 0, 1}, false, false, 0, 0.001);
  EXPECT_EQ(slew.follow({0, 0, 0}, false, false, 0, 0.001).z, 0);
  EXPECT_EQ(slew.follow({0, 0, 1}, false, false, 0, 0.001).z, 1);
  EXPECT_EQ(slew.follow({0, 0, 0}, true, false, 1, 0.001).z, 0) << "the hand's own motion";
  EXPECT_LT(slew.follow({0, 0, 1}, true, false, 0, 0.001).z, 0.1) << "and what it does not explain";
  EXPECT_LT(slew.follow({0, 0, 1}, false, false, 0, 0.001).z, 0.2) << "it catches up when the drill stops";
}

// Through an uneven floor onto a dura: no jump but in the one event, and both are felt where both are touched.
TEST(HapticsSlew, AFloorThatGivesWay) {
  const Drilled is = through();
  std::printf("  of %llu ticks %llu above 0.05, %llu above 0.1 N/ms, at most %.3f; %llu turns\n",
              static_cast<unsigned long long>(is.changes.ticks), static_cast<unsigned long long>(is.changes.above[1]),
              static_cast<unsigned long long>(is.changes.above[2]), is.changes.max_n_per_ms,
              static_cast<unsigned long long>(is.changes.turns));
  ASSERT_TRUE(is.breached);
  EXPECT_EQ(is.breaches, 1);
  EXPECT_EQ(is.changes.above[2], is.changes.named) << "a change above 0.1 N/ms without a name";
}

namespace {

struct Move {
  Vec3 to;
  int ticks;
  std::uint32_t buttons;
};

// How many breaches each move tells of a ball of 4 mm at a plate of 3 mm, 18 mm wide; the drill has been through first.
std::vector<int> breaches_of(const std::vector<Move>& moves, bool& breached) {
  voxel::HapticVolume volume = empty(44, {0.5, 0.5, 0.5});
  fill_wide(volume, 1, [](Vec3 p) { return std::min(1.5 - std::abs(p.z), 9 - std::abs(p.y)); });
  contact::ContactVolume contact(volume);
  drill::DrillShapes shapes;
  shapes[1] = {true, 0.02};
  haptics::DrillingParams params;
  params.drill = true;
  const haptics::ToolParams tool = haptics::own_tool(params_of("ball", 4));
  haptics::Drilling drilling(volume, contact, shapes, params, {}, haptics::cutter_of(params, tool));
  haptics::Proxy proxy(contact, one_shape(1, face(1, 0.35, 0.3), face(1, 0.35, 0.3)), {}, {}, haptics::make_tool(tool));
  std::vector<int> breaches;
  Vec3 tip{-4, 0, 3};
  for (const Move& move : moves) {
    int told = 0;
    const Vec3 from = tip;
    for (int n = 1; n <= move.ticks; ++n) {
      tip = from + (move.to - from) * (double(n) / move.ticks);
      haptics::HapticInput in = pose(tip, {0, 0, 1});
      in.buttons = move.buttons;
      drilling.prepare(in);
      const haptics::HapticState& is = proxy.update(in);
      drilling.tick(in, is);
      told += (is.events & haptics::haptic_event::breach) != 0;
    }
    breaches.push_back(told);
  }
  breached = drilling.outcome().breached;
  return breaches;
}

constexpr std::uint32_t up = 0, down = haptics::Drilling::pedal;

}  // namespace

// Two holes through a plate are two breaches, and the way through the first hole again is none.
TEST(HapticsSlew, EachPassThroughBoneIsABreach) {
  std::vector<Move> moves;
  for (const double x : {-4.0, -4.0, 4.0})
    for (const Move& m : {Move{{x, 0, 3}, 100, up}, {{x, 0, -4}, 700, down}, {{x, 0, 3}, 100, up}}) moves.push_back(m);
  bool breached = false;
  EXPECT_EQ(breaches_of(moves, breached), (std::vector<int>{0, 1, 0, 0, 0, 0, 0, 1, 0}));
  EXPECT_TRUE(breached);
}

// A pit that is left with the pedal up is no way through: neither where the drill then runs beside the bone, nor where
// it goes through the hole that it made before.
TEST(HapticsSlew, APitThatWasLeftIsNoBreachElsewhere) {
  const std::vector<Move> pit = {{{-4, 0, 3}, 100, up}, {{-4, 0, 0.2}, 400, down}, {{-4, 0, 4}, 100, up}},
                          beside = {{{-4, 12.5, 4}, 100, up},
                                    {{-4, 12.5, -1}, 100, up},
                                    {{-4, 12.5, -4}, 100, down},
                                    {{-4, 12.5, 4}, 100, up}},
                          hole = {{{4, 0, 4}, 100, up}, {{4, 0, -4}, 700, down}, {{4, 0, 4}, 100, up}},
                          again = {{{4, 0, 4}, 100, up},
                                   {{4, 0, 0.5}, 100, up},
                                   {{4, 0, -4}, 100, down},
                                   {{4, 0, 4}, 100, up}};
  const auto told = [&](std::initializer_list<const std::vector<Move>*> parts, bool& breached) {
    std::vector<Move> moves;
    for (const std::vector<Move>* part : parts) moves.insert(moves.end(), part->begin(), part->end());
    const std::vector<int> each = breaches_of(moves, breached);
    std::vector<int> sums;
    auto from = each.begin();
    for (const std::vector<Move>* part : parts) {
      sums.push_back(std::accumulate(from, from + std::ptrdiff_t(part->size()), 0));
      from += std::ptrdiff_t(part->size());
    }
    return sums;
  };
  // Out to look, back to the pit's bottom, and through.
  const std::vector<Move> second_go = {
      {{-4, 0, 4}, 100, up}, {{-4, 0, 0.4}, 100, up}, {{-4, 0, -4}, 700, down}, {{-4, 0, 4}, 100, up}};
  bool breached = false;
  EXPECT_EQ(told({&pit, &second_go}, breached), (std::vector<int>{0, 1}));
  EXPECT_TRUE(breached);
  EXPECT_EQ(told({&pit, &beside}, breached), (std::vector<int>{0, 0}));
  EXPECT_FALSE(breached);
  EXPECT_EQ(told({&hole, &pit, &again}, breached), (std::vector<int>{1, 0, 0}));
}
