// SPDX-License-Identifier: GPL-3.0-or-later
// Strokes and incisions that are taken back while the hand goes on: what is felt, recorded and replayed.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstring>
#include <filesystem>

#include "haptics/recording.h"
#include "haptics_only_sleep.h"
#include "haptics_tools.h"
#include "session/playback.h"

using namespace trephine;
using namespace trephine::tools;

namespace {

constexpr std::uint32_t undo = std::uint32_t(haptics::belt_command::undo) << haptics::belt_button::command_shift,
                        reset = std::uint32_t(haptics::belt_command::reset) << haptics::belt_button::command_shift,
                        pedal = haptics::Drilling::pedal, mark = haptics::Drilling::mark;

// Skin of 2 mm on bone.
voxel::HapticVolume head() {
  voxel::HapticVolume v = empty(48, {0.5, 0.5, 0.5});
  fill(v, 1, [](Vec3 p) { return 0.5 * -p.z; });
  fill(v, 2, [](Vec3 p) { return 0.5 * std::min(p.z, 2 - p.z); });
  return v;
}

struct Scene {
  voxel::HapticVolume volume = head();
  contact::ContactVolume contact{volume};
  haptics::Feels feels = untouchable();
  drill::DrillShapes shapes;
  haptics::ForceParams force;
  haptics::DrillingParams params;
  haptics::ToolParams tool = params_of("ball", 4);
  std::unique_ptr<haptics::Drilling> drilling;
  std::unique_ptr<haptics::Proxy> proxy;
  explicit Scene(std::int64_t undo_steps = 20) {
    feels[1].front = feels[1].back = face(1, 0.35, 0.3, 0, 0.0003);
    feels[2].front = face(0.2, 0.3, 0.25);
    shapes[1] = {true, 0.05};
    shapes[2] = {true, 0};
    params.drill = true;
    params.incision_radius_mm = 6;
    params.undo_steps = undo_steps;
    drilling = std::make_unique<haptics::Drilling>(volume, contact, shapes, params, drill::DrillParams{},
                                                   haptics::cutter_of(params, haptics::own_tool(tool)));
    proxy = std::make_unique<haptics::Proxy>(contact, feels, force, haptics::ShaftParams{}, haptics::make_tool(tool));
  }
};

// What the hand does: an incision, two strokes, undo with the tool in the hole, a stroke, reset, and a last stroke.
std::vector<haptics::ServoFrame> hands_way() {
  std::vector<haptics::ServoFrame> frames;
  const auto go = [&](double x, double from_z, double to_z, int ticks, std::uint32_t buttons) {
    for (int n = 0; n < ticks; ++n) {
      haptics::ServoFrame f;
      f.tick = frames.size();
      f.dt_s = 0.001;
      f.time_s = 0.001 * double(f.tick + 1);
      f.tip_mm[0] = x;
      f.tip_mm[2] = from_z + (to_z - from_z) * n / ticks;
      f.axis[2] = 1;
      f.buttons = buttons;
      frames.push_back(f);
    }
  };
  go(0, 5, 2, 100, 0);
  go(0, 2, 2, 30, mark);
  go(0, 2, -1, 400, pedal);
  go(0, -1, 3, 200, 0);
  go(3, 3, -1, 400, pedal);
  go(3, -1, -1, 50, 0);
  go(3, -1, -1, 50, undo);
  go(3, -1, 4, 200, 0);
  go(-3, 4, -1, 400, pedal);
  go(-3, -1, 4, 200, 0);
  go(-3, 4, 4, 50, reset);
  go(-3, 4, 1, 300, 0);
  go(1, 3, 3, 30, mark);
  go(1, 1, -2, 300, pedal);
  go(1, -1, 3, 200, 0);
  return frames;
}

struct Went {
  std::vector<haptics::ServoFrame> frames;
  std::vector<std::string> volumes;  // after each change of the pedal or command
  haptics::DrillingOutcome outcome;
};

Went run(Scene& s, const std::vector<haptics::ServoFrame>& given) {
  Went r;
  std::uint32_t before = 0;
  for (const haptics::ServoFrame& f : given) {
    if (f.buttons != before) r.volumes.push_back(haptics::volume_digest(s.volume));
    before = f.buttons;
    const auto out = haptics::replay_frames({f}, 1000, *s.proxy, s.drilling.get());
    r.frames.push_back(out.front());
  }
  r.volumes.push_back(haptics::volume_digest(s.volume));
  r.outcome = s.drilling->outcome();
  return r;
}

}  // namespace

TEST(HapticsUndo, TheLastStrokeAndAllOfThem) {
  Scene s;
  const std::string begin = haptics::volume_digest(s.volume);
  const Went r = run(s, hands_way());
  // 0 begin, 1 mark, 2 stroke, 3 up, 4 stroke, 5 up, 6 undo, 7 on, 8 stroke, 9 up, 10 reset, 11 on, 12 mark, 13 stroke,
  // 14 up
  ASSERT_EQ(r.volumes.size(), 15u);
  EXPECT_EQ(r.volumes[0], begin);
  EXPECT_NE(r.volumes[1], begin) << "incised";
  EXPECT_NE(r.volumes[2], r.volumes[1]) << "drilled";
  EXPECT_EQ(r.volumes[3], r.volumes[2]);
  EXPECT_NE(r.volumes[4], r.volumes[3]) << "drilled";
  EXPECT_EQ(r.volumes[6], r.volumes[3]) << "the second stroke was taken back";
  EXPECT_NE(r.volumes[8], r.volumes[6]);
  EXPECT_EQ(r.volumes[10], begin) << "all was taken back";
  EXPECT_EQ(r.volumes[11], begin);
  EXPECT_NE(r.volumes[12], begin) << "incised";
  EXPECT_NE(r.volumes[13], r.volumes[12]) << "drilled";
  EXPECT_EQ(r.outcome.undone, 1);
  EXPECT_EQ(r.outcome.resets, 1);
  EXPECT_EQ(r.outcome.incisions, 1);
  EXPECT_GT(r.outcome.units[1], 0);
  // The hand is not struck: neither where bone comes back around the tool nor afterwards.
  Vec3 last;
  for (const haptics::ServoFrame& f : r.frames) {
    const Vec3 is{f.force_n[0], f.force_n[1], f.force_n[2]};
    ASSERT_LE(norm(is - last), s.force.force_rate_n_per_s() * 0.001 + 1e-9) << f.tick;
    ASSERT_EQ(f.faults, 0u);
    last = is;
  }
  // Bit for bit again, and the same strokes without a step to take back leave another volume.
  Scene again;
  const Went same = run(again, r.frames);
  for (std::size_t n = 0; n < r.frames.size(); ++n) ASSERT_TRUE(haptics::same_frame(r.frames[n], same.frames[n])) << n;
  EXPECT_EQ(same.volumes, r.volumes);
  Scene none(0);
  const Went kept = run(none, hands_way());
  EXPECT_EQ(kept.volumes[6], kept.volumes[4]) << "the command says nothing";
  EXPECT_EQ(kept.outcome.undone, 0);
}

// In a lesson nothing is felt after an undo until the pose was outside, as after a pause; a tool that was in the hole
// is in bone again, and the drill must not have it there.
TEST(HapticsUndo, ABeltWaitsForAPoseOutside) {
  Scene s;
  haptics::BeltToolParams burr;
  static_cast<haptics::ToolParams&>(burr) = s.tool;
  burr.name = "burr";
  burr.cuts = true;
  haptics::ToolBelt belt(s.contact, s.feels, s.force, {}, {burr}, s.drilling.get());
  s.shapes[2] = {};
  std::vector<haptics::ServoFrame> frames;
  const auto go = [&](double from_z, double to_z, int ticks, std::uint32_t buttons) {
    for (int n = 0; n < ticks; ++n) {
      haptics::HapticInput in = pose({0, 0, from_z + (to_z - from_z) * n / ticks}, {0, 0, 1});
      in.buttons = buttons;
      const haptics::HapticState is = belt.update(in);
      belt.after(in, is);
      haptics::ServoFrame f;
      haptics::put_input(in, f);
      haptics::put_answer(is, f);
      f.dt_s = 0.001;
      f.time_s = 0.001 * double(frames.size() + 1);
      frames.push_back(f);
    }
  };
  s.drilling->incise_at({0, 0, 2});
  go(6, 1, 600, 0);
  go(1, -3, 1500, pedal);
  const std::string drilled = haptics::volume_digest(s.volume);
  ASSERT_GT(s.drilling->outcome().units[1], 0);
  go(-3, -3, 20, 0);
  go(-3, -3, 100, undo);
  EXPECT_NE(haptics::volume_digest(s.volume), drilled);
  EXPECT_EQ(s.drilling->outcome().units[1], 0);
  go(-3, -3, 200, pedal);
  EXPECT_EQ(s.drilling->outcome().units[1], 0) << "it drills from within bone";
  EXPECT_EQ(frames.back().touched, 0);
  go(-3, 5, 200, 0);
  go(5, -2, 1200, pedal);
  EXPECT_GT(s.drilling->outcome().units[1], 0) << "and goes on from outside";
}

// What is shown of incisions follows what was taken back.
TEST(HapticsUndo, IncisionsAreTakenOffTheList) {
  haptics::DrillingParams params;
  params.drill = true;
  haptics::RecordingHeader header;
  header.drilling = params;
  session::IncisionWatch watch(header);
  std::vector<session::IncisionMark> marks;
  haptics::ServoFrame f;
  const auto tick = [&](std::uint32_t buttons, int touched = 0) {
    f.buttons = buttons;
    f.touched = touched;
    watch.look(f, marks);
  };
  for (const std::uint32_t b : {mark, 0u, mark, 0u}) tick(b);
  EXPECT_EQ(marks.size(), 2u);
  tick(pedal, 1);
  tick(0);
  tick(undo);
  EXPECT_EQ(marks.size(), 2u) << "the stroke was taken back";
  tick(0);
  tick(pedal, 0);  // in the air: no step
  tick(0);
  tick(undo);
  EXPECT_EQ(marks.size(), 1u);
  tick(0);
  tick(mark);
  tick(reset);
  EXPECT_EQ(marks.size(), 0u);
  tick(0);
  tick(undo);
  EXPECT_EQ(marks.size(), 0u);
}

// No allocation and no system call, whatever is taken back.
TEST(HapticsUndo, ItsTicksMakeNoSystemCall) {
  if (sanitized) GTEST_SKIP() << "sanitizers make calls of their own";
  Scene s;
  const std::vector<haptics::ServoFrame> way = hands_way();
  const pid_t child = fork();
  if (child == 0) {
    allow_only_sleep();
    counting_allocations = true;
    for (const haptics::ServoFrame& f : way) {
      haptics::HapticInput in = pose({f.tip_mm[0], f.tip_mm[1], f.tip_mm[2]}, {0, 0, 1});
      in.buttons = f.buttons;
      s.drilling->prepare(in);
      s.drilling->tick(in, s.proxy->update(in));
    }
    counting_allocations = false;
    syscall(SYS_exit_group, allocations != 0 ? 1 : s.drilling->outcome().resets != 1 ? 2 : 0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFEXITED(status)) << "killed by signal " << WTERMSIG(status);
  EXPECT_EQ(WEXITSTATUS(status), 0) << "1: allocated; 2: nothing was taken back; 3: no filter";
}
