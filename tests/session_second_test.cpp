// SPDX-License-Identifier: GPL-3.0-or-later
// Two hands in one loop: what the second one feels, that the first feels the same bits with and without it, what a
// spoilt second device does, and the recording of both.
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <functional>
#include <limits>

#include "base/error.h"
#include "haptics/recording.h"
#include "haptics_tools.h"
#include "scratch_folder.h"
#include "session/second_hand.h"

using namespace trephine;
using namespace trephine::tools;

namespace {

using haptics::ServoFrame;
constexpr double rate_hz = 1000;
constexpr int ticks = 900;
constexpr std::uint32_t pedal = haptics::Drilling::pedal;

/// A device that is where `at` says in each tick; false: it is lost.
struct Led : device::Device {
  using At = std::function<bool(int tick, device::DeviceReading& out)>;
  explicit Led(At where) : at(std::move(where)) {}
  double damping_n_s_per_mm() const override { return 0; }
  bool read(double, device::DeviceReading& out) override { return at(tick++, out); }
  void send(Vec3 force_n) override { sent_n.push_back(norm(force_n)); }
  At at;
  int tick = 0;
  std::vector<double> sent_n;
};

// From 4 mm above the floor to 1.5 mm below it at that place, in 300 ticks, and there it stays.
Led::At presses(double x) {
  return [x](int tick, device::DeviceReading& out) {
    out.tip_mm = {x, 0, std::max(-1.5, 4 - 5.5 * tick / 300)};
    out.buttons = tick > 400 ? pedal : 0;
    return true;
  };
}

struct Session {
  voxel::HapticVolume volume = floor_volume();
  contact::ContactVolume contact{volume};
  haptics::Feels feels = untouchable();
  drill::DrillShapes shapes;
  haptics::RecordingHeader header;
  std::unique_ptr<haptics::Drilling> drilling;
  std::unique_ptr<haptics::Proxy> proxy;
  std::unique_ptr<session::SecondHand> second;
  Session(bool two, Led* device, double second_max_n = 3.3) {
    feels[1].front = feels[1].back = face(1, 0.35, 0.3);
    shapes[1] = {true, 0.05};
    header.tool = haptics::own_tool(params_of("ball", 4));
    header.drilling.drill = true;
    header.force.ramp_s = 0;
    header.rate_hz = rate_hz;
    drilling = std::make_unique<haptics::Drilling>(volume, contact, shapes, header.drilling, header.law,
                                                   haptics::cutter_of(header.drilling, header.tool));
    proxy =
        std::make_unique<haptics::Proxy>(contact, feels, header.force, header.shaft, haptics::make_tool(header.tool));
    if (!two) return;
    header.second =
        haptics::RecordedSecondHand{"led", false, header.force, {}, session::second_tool(params_of("suction"))};
    header.second->force.max_force_n = second_max_n;
    second = std::make_unique<session::SecondHand>(touch::FeltSpace(contact), feels, header, drilling.get(), device);
  }
};

struct Both {
  std::vector<ServoFrame> first, second;
};

Both run(Session& s, Led& first) {
  haptics::ServoParams params;
  params.rate_hz = rate_hz;
  params.paced = params.realtime = false;
  haptics::FrameQueue queue(2 * ticks);
  haptics::Servo servo(*s.proxy, first, params, &queue, s.drilling.get());
  if (s.second) servo.set_other(s.second.get());
  for (int n = 0; n < ticks; ++n) servo.tick(1 / rate_hz, 0);
  Both both;
  session::drain(queue, s.second != nullptr, both.first, both.second);
  return both;
}

Both with_second(Led::At second, double most_n = 3.3) {
  Led first(presses(-4)), other(std::move(second));
  Session s(true, &other, most_n);
  return run(s, first);
}

std::size_t unlike(const std::vector<ServoFrame>& a, const std::vector<ServoFrame>& b) {
  EXPECT_EQ(a.size(), b.size());
  std::size_t count = 0;
  for (std::size_t n = 0; n < std::min(a.size(), b.size()); ++n) count += !haptics::same_frame(a[n], b[n]);
  return count;
}
double force_of(const ServoFrame& f) { return norm({f.force_n[0], f.force_n[1], f.force_n[2]}); }
int code_of(const std::function<void()>& f) {
  try {
    f();
  } catch (const Error& e) {
    return int(e.code());
  }
  return 0;
}

// What the first hand did alone, once for all tests.
const std::vector<ServoFrame>& alone() {
  static const std::vector<ServoFrame> frames = [] {
    Led first(presses(-4));
    Session s(false, nullptr);
    return run(s, first).first;
  }();
  return frames;
}

}  // namespace

TEST(TwoHands, EachFeelsItsOwnContactAndTheFirstTheSameBits) {
  const Both both = with_second(presses(5));
  EXPECT_EQ(both.first.size(), std::size_t(ticks));
  EXPECT_EQ(unlike(both.first, alone()), 0u);
  const ServoFrame &f = both.first[380], &s = both.second[380];
  EXPECT_GT(force_of(f), 0.5);
  EXPECT_GT(force_of(s), 0.5);
  EXPECT_EQ(s.touched, 1);
  EXPECT_LT(norm({s.proxy_mm[0] - 5, s.proxy_mm[1], 0}), 0.5);  // at its own place
  for (int n = 0; n < ticks; ++n) {
    ASSERT_EQ(both.second[std::size_t(n)].tick, std::uint64_t(n));
    ASSERT_EQ(both.second[std::size_t(n)].time_s, both.first[std::size_t(n)].time_s);
  }
}

TEST(TwoHands, ALimitOfTheSecondDeviceHoldsForItAlone) {
  const Both both = with_second(presses(5), 0.4);
  double most = 0;
  for (const ServoFrame& s : both.second) most = std::max(most, force_of(s));
  EXPECT_LE(most, 0.4 + 1e-12);
  EXPECT_GT(most, 0.39);
  EXPECT_EQ(unlike(both.first, alone()), 0u);
}

// A second device that is lost, says what is no number, jumps or is silent leaves the first hand as it is.
TEST(TwoHands, ASpoiltSecondDeviceIsItsOwnFault) {
  struct Case {
    const char* what;
    std::function<bool(int, device::DeviceReading&)> spoil;
    std::uint32_t fault;
    bool lasts;
  };
  const double no_number = std::numeric_limits<double>::quiet_NaN();
  const Case cases[] = {
      {"lost", [](int n, auto&) { return n < 500; }, haptics::haptic_fault::device_lost, true},
      {"no number",
       [&](int n, auto& out) {
         if (n >= 500) out.tip_mm.x = no_number;
         return true;
       },
       haptics::haptic_fault::pose, true},
      {"jumps",
       [](int n, auto& out) {
         if (n >= 500) out.tip_mm += Vec3{-3, 60, 0};
         if (n >= 520) out.tip_mm.y -= 60;
         return true;
       },
       haptics::haptic_fault::jump, false},
      {"silent",
       [](int n, auto& out) {
         out.silent = n >= 500 && n < 600;
         return true;
       },
       haptics::haptic_fault::gap, false},
  };
  for (const Case& c : cases) {
    const auto where = presses(5);
    const Both both = with_second([&](int n, device::DeviceReading& out) {
      where(n, out);
      return c.spoil(n, out);
    });
    EXPECT_EQ(unlike(both.first, alone()), 0u) << c.what;
    EXPECT_EQ(both.second[499].faults, 0u) << c.what;
    EXPECT_EQ(both.second[500].faults, c.fault) << c.what;
    EXPECT_EQ(force_of(both.second[500]), 0) << c.what;
    EXPECT_EQ(both.second.back().faults, c.lasts ? c.fault : 0u) << c.what;
    if (c.lasts) EXPECT_EQ(force_of(both.second.back()), 0) << c.what;
    if (std::strcmp(c.what, "silent") == 0) EXPECT_GT(force_of(both.second.back()), 0.5);
  }
}

TEST(TwoHands, ASwitchAloneFeelsNothingAndKeepsItsSwitch) {
  Led first(presses(-4)), other(presses(5));
  Session s(true, &other);
  s.header.second->switch_only = true;
  s.second =
      std::make_unique<session::SecondHand>(touch::FeltSpace(s.contact), s.feels, s.header, s.drilling.get(), &other);
  const Both both = run(s, first);
  for (const ServoFrame& f : both.second) ASSERT_EQ(force_of(f), 0);
  EXPECT_EQ(both.second.back().buttons & pedal, pedal);
  EXPECT_EQ(both.second.back().touched, 0);
}

// Also where the first hand's cuts change what the second one lies on.
TEST(TwoHands, BothReplayBitForBit) {
  const Both was = with_second(presses(-1.5));
  Session s(true, nullptr);
  Both again;
  for (std::size_t n = 0; n < was.first.size(); ++n) {
    again.first.push_back(haptics::replay_frames({was.first[n]}, rate_hz, *s.proxy, s.drilling.get()).front());
    again.second.push_back(s.second->again(was.second[n], nullptr));
  }
  EXPECT_EQ(unlike(again.first, was.first), 0u);
  EXPECT_EQ(unlike(again.second, was.second), 0u);
  // With the volume as it was before, the second hand would have felt something else: the hole reaches under it.
  Session whole(true, nullptr);
  std::size_t other = 0;
  for (const ServoFrame& f : was.second) other += !haptics::same_frame(whole.second->again(f, nullptr), f);
  EXPECT_GT(other, 50u);
}

// What the first hand's belt did with a command counts, not the command: it may refuse one, and the second device may
// be silent when one comes.
TEST(TwoHands, TheSecondFollowsWhatTheFirstDidWithACommand) {
  constexpr int open_mm = 4, down_mm = -2;
  const auto at = [](double x, double z, std::uint32_t buttons = 0) {
    device::DeviceReading r;
    r.tip_mm = {x, 0, z};
    r.buttons = buttons;
    return r;
  };
  const auto command = [](int c) { return std::uint32_t(c) << haptics::belt_button::command_shift; };
  // Each hand goes down from one tick on, over 300 ticks; the first may come up again.
  const auto way = [](int tick, int from) {
    return open_mm - (open_mm - down_mm) * std::clamp(tick - from, 0, 300) / 300.0;
  };
  const auto last_force_n = [&](const std::function<device::DeviceReading(int)>& first,
                                const std::function<device::DeviceReading(int)>& second) {
    const auto led = [](const auto& where) {
      return [&where](int tick, device::DeviceReading& out) {
        out = where(tick);
        return true;
      };
    };
    Led one(led(first)), two(led(second));
    Session s(true, &two);
    haptics::BeltToolParams ball;
    static_cast<haptics::ToolParams&>(ball) = s.header.tool;
    ball.cuts = true;
    haptics::ToolBelt belt(s.contact, s.feels, s.header.force, s.header.shaft, {ball}, s.drilling.get());
    haptics::ServoParams params;
    params.rate_hz = rate_hz;
    haptics::FrameQueue queue(2 * ticks);
    haptics::Servo servo(belt, one, params, &queue);
    servo.set_other(s.second.get());
    for (int n = 0; n < ticks; ++n) servo.tick(1 / rate_hz, 0);
    Both both;
    session::drain(queue, true, both.first, both.second);
    for (const ServoFrame& f : both.second) EXPECT_EQ(f.buttons & command(haptics::belt_button::command_mask), 0u);
    return force_of(both.second.back());
  };
  namespace belt_command = haptics::belt_command;
  const auto pauses = [&](int n) { return n >= 450 && n < 460 ? command(belt_command::pause) : 0; };
  const auto presses_from = [&](int from) { return [&, from](int n) { return at(5, way(n, from)); }; };
  EXPECT_GT(last_force_n([&](int n) { return at(-4, way(n, 0), pauses(n)); }, presses_from(500)), 0.5)
      << "the first touches and refuses the pause";
  EXPECT_EQ(last_force_n([&](int n) { return at(-4, open_mm, pauses(n)); }, presses_from(0)), 0)
      << "the first takes the pause while the second touches";
  const auto resumes = [&](int n) {
    return n >= 100 && n < 110 ? command(belt_command::pause) : n >= 300 ? command(belt_command::resume) : 0;
  };
  EXPECT_GT(last_force_n([&](int n) { return at(-4, open_mm, resumes(n)); },
                         [&](int n) {
                           device::DeviceReading r = at(5, way(n, 450));
                           r.silent = n > 250 && n < 350;
                           return r;
                         }),
            0.5)
      << "the second is silent while the lesson goes on";
  // The first drills until tick 500 and is in the open from 550 on.
  const auto drills = [&](std::uint32_t pedal_at_700) {
    return [&, pedal_at_700](int n) {
      if (n < 500) return at(-4, way(n, 0), n > 300 ? pedal : 0);
      return at(-4, std::min(double(open_mm), down_mm + (open_mm - down_mm) * (n - 500) / 50.0),
                n < 700 ? 0 : command(belt_command::undo) | pedal_at_700);
    };
  };
  const auto with_switch = [&](std::uint32_t down) { return [&, down](int n) { return at(5, way(n, 0), down); }; };
  EXPECT_EQ(last_force_n(drills(0), with_switch(pedal)), 0) << "bone is put back, with the second one's switch down";
  EXPECT_GT(last_force_n(drills(pedal), with_switch(0)), 0.5) << "the first one's pedal is down: nothing is put back";
}

TEST(TwoHands, ARecordingHoldsBoth) {
  const Both both = with_second(presses(5));
  Led device(presses(5));
  const Session s(true, &device);
  const ScratchFolder folder;
  const std::filesystem::path file = folder.path() / "both.servo";
  haptics::RecordingWriter writer(file, s.header);
  writer.add(both.first, both.second);
  EXPECT_EQ(code_of([&] { writer.add(both.first, {}); }), int(ExitCode::internal));
  writer.finish();
  EXPECT_EQ(std::filesystem::file_size(file), 16u + 8192 + 2 * haptics::short_frame_bytes * ticks);
  const haptics::Recording read = haptics::read_recording(file);
  EXPECT_EQ(read.seal, haptics::Seal::whole);
  EXPECT_EQ(read.header.second->tool.name, "suction");
  EXPECT_TRUE(read.header.second->tool.blunt);
  EXPECT_EQ(unlike(read.frames, both.first), 0u);
  EXPECT_EQ(unlike(read.second, both.second), 0u);
  // Another force of the second hand breaks the seal; another tick is no recording of two hands.
  const auto changed = [&](std::size_t at) {
    std::fstream bytes(file, std::ios::in | std::ios::out | std::ios::binary);
    bytes.seekp(std::streamoff(16 + 8192 + haptics::short_frame_bytes + at));
    bytes.put(1);
  };
  changed(offsetof(ServoFrame, force_n));
  EXPECT_EQ(haptics::read_recording(file).seal, haptics::Seal::broken);
  changed(offsetof(ServoFrame, tick));
  EXPECT_EQ(code_of([&] { haptics::read_recording(file); }), int(ExitCode::bad_input));
}

TEST(TwoHands, WhatTheSecondHandCannotHoldIsRefused) {
  for (const char* kind : {"burr", "scalpel", "marker", "points"})
    EXPECT_EQ(code_of([&] { session::second_tool(params_of(kind)); }), int(ExitCode::usage)) << kind;
  EXPECT_FALSE(session::second_tool(params_of("rod")).blunt);
  device::DeviceChoice first, second;
  first.name = second.name = "udp";  // both at the port that is usual
  EXPECT_EQ(code_of([&] { session::require_two_devices(first, second); }), int(ExitCode::usage));
  first.name = "";  // a window's mouse
  EXPECT_EQ(code_of([&] { session::require_two_devices(first, second); }), 0);
  first.name = second.name = "trajectory";  // a file that both may play
  EXPECT_EQ(code_of([&] { session::require_two_devices(first, second); }), 0);
}
