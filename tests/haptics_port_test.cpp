// SPDX-License-Identifier: GPL-3.0-or-later
// What lies between a device and the tool: jumps and gaps.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <map>
#include <thread>

#include "device/udp_device.h"
#include "device_udp_client.h"
#include "haptics/recording.h"
#include "haptics/servo.h"
#include "haptics_floor.h"

using namespace trephine;
using namespace trephine::haptic_scenes;
using walls::uniform;

namespace {

const std::atomic<bool> never{false};

haptics::ServoParams unpaced() {
  haptics::ServoParams p;
  p.paced = p.realtime = false;
  return p;
}

class ToldDevice : public device::Device {
 public:
  std::function<Vec3(int)> tip = [](int) { return Vec3{}; };
  device::DeviceReading says;
  int tick = 0;
  Vec3 sent;
  double damping_n_s_per_mm() const override { return 0; }
  bool read(double, device::DeviceReading& out) override {
    out = says;
    out.tip_mm = tip(tick++);
    return true;
  }
  void send(Vec3 force_n) override { sent = force_n; }
};

struct Told {
  std::vector<haptics::ServoFrame> frames;
  std::uint64_t jumps = 0;
};
Told run(const Floor& floor, const std::function<Vec3(int)>& tip, int ticks, std::uint32_t buttons = 0) {
  ToldDevice device;
  device.tip = tip;
  device.says.buttons = buttons;
  haptics::Proxy proxy(*floor.contact, floor.feels, device_limits());
  haptics::DevicePort port(haptics::PortParams{}, device_limits());
  haptics::FrameQueue queue(1 << 14);
  haptics::Servo servo(proxy, device, unpaced(), &queue);
  servo.set_port(&port);
  servo.run(std::uint64_t(ticks), never);
  Told t;
  queue.drain(t.frames);
  t.jumps = port.jumps();
  return t;
}
double force_of(const haptics::ServoFrame& f) { return norm(Vec3{f.force_n[0], f.force_n[1], f.force_n[2]}); }

int differing(const Floor& floor, const std::vector<haptics::ServoFrame>& frames, const haptics::PortParams& params) {
  haptics::Proxy proxy(*floor.contact, floor.feels, device_limits());
  haptics::DevicePort port(params, device_limits());
  const auto again = haptics::replay_frames(frames, 1000, proxy, nullptr, &port);
  int n = 0;
  for (std::size_t k = 0; k < frames.size(); ++k) n += !haptics::same_frame(frames[k], again[k]);
  return n;
}

}  // namespace

TEST(HapticsPort, AJumpThatNoHandDoesIsAFaultThatPasses) {
  const Floor floor;
  // Down to 1 mm deep; after 200 ticks by 50 mm along the floor, in one tick.
  const auto tip = [](int n) { return Vec3{n < 200 ? 0.0 : 50.0, 0, std::max(-1.0, 1 - 0.02 * n)}; };
  const Told t = run(floor, tip, 600);
  ASSERT_EQ(t.frames.size(), 600u);
  EXPECT_EQ(t.jumps, 1u);
  EXPECT_GT(force_of(t.frames[199]), 0.4);
  for (int n = 0; n < 600; ++n) EXPECT_EQ(t.frames[std::size_t(n)].faults, n == 200 ? haptics::haptic_fault::jump : 0u);
  EXPECT_EQ(haptics::fault_names(t.frames[200].faults), "jump");
  EXPECT_EQ(force_of(t.frames[200]), 0);
  double before = 0, most = 0;
  for (int n = 201; n < 600; ++n) {
    const double force = force_of(t.frames[std::size_t(n)]);
    EXPECT_LE(force, 1.0 * (n - 200) / 100 + 1e-9) << "let in over 100 ms";
    EXPECT_LT(force - before, 0.05) << n;
    most = std::max(most, before = force);
  }
  EXPECT_EQ(differing(floor, t.frames, {}), 0);
  std::vector<haptics::ServoFrame> spoilt = t.frames;
  spoilt[200].faults = 0;
  EXPECT_GT(differing(floor, spoilt, {}), 0) << "a jump that was wiped out is found";
}

TEST(HapticsPort, WhatAHandCanDoIsNoJump) {
  const Floor floor;
  const auto jumps = [&](const std::function<Vec3(int)>& tip, std::uint32_t buttons = 0) {
    const Told t = run(floor, tip, 300, buttons);
    EXPECT_EQ(differing(floor, t.frames, {}), 0);
    return t.jumps;
  };
  EXPECT_EQ(jumps([](int n) { return Vec3{-50 + 3.5 * (n % 30), 0, 5}; }), 9u) << "but the way back";
  EXPECT_EQ(jumps([](int n) { return Vec3{-50.0 + 33 * (n / 100), 0, 5}; }), 0u) << "2 m/s at 60 Hz";
  EXPECT_EQ(jumps([](int n) { return Vec3{n % 2 ? 45.0 : -45.0, 0, 5}; }, haptics::haptic_button::lifted), 0u);
  EXPECT_EQ(jumps([](int n) { return Vec3{n < 100 ? 0 : 45.0, 0, 5}; }), 1u);
}

// Without a port's parameters, as in recordings before there was one, nothing is changed by a bit.
TEST(HapticsPort, RecordingsWithoutItReplayAsTheyWere) {
  const Floor floor;
  std::mt19937_64 rng(5);
  std::vector<haptics::ServoFrame> frames;
  haptics::Proxy proxy(*floor.contact, floor.feels, device_limits());
  for (int n = 0; n < 2000; ++n) {
    haptics::ServoFrame f;
    f.tick = std::uint64_t(n);
    f.dt_s = 0.001;
    for (double& v : f.tip_mm) v = uniform(rng, -30, 30);
    f.axis[2] = 1;
    f.buttons = n % 97 == 0 ? haptics::haptic_button::lifted : 0;
    frames.push_back(f);
  }
  frames = haptics::replay_frames(frames, 1000, proxy);
  EXPECT_EQ(differing(floor, frames, haptics::PortParams::none()), 0);
  EXPECT_GT(differing(floor, frames, {}), 0);
}

// ---------------------------------------------------------------------------------------------------------- gaps

namespace {

std::atomic<std::int64_t> virtual_ns{0};
std::int64_t virtual_clock() { return virtual_ns.load(); }

}  // namespace

// A client over the loopback, whose silence is that of a clock of the test's own.
TEST(HapticsPort, UdpGoesOnAfterAGap) {
  const Floor floor;
  device::UdpParams params;
  params.port = 0;
  virtual_ns = 1000000000;
  device::UdpDevice device(params, false, virtual_clock);
  haptics::Proxy proxy(*floor.contact, floor.feels, device_limits());
  haptics::DevicePort port(haptics::PortParams{}, device_limits());
  haptics::FrameQueue queue(1 << 14);
  haptics::Servo servo(proxy, device, unpaced(), &queue);
  servo.set_port(&port);
  UdpClient client(device.port());
  client.next.reading.buttons = 1;
  client.next.pedals = 1;
  std::vector<haptics::ServoFrame> frames;
  const auto taken = [&] {
    for (const auto& [name, count] : device.counts())
      if (name == "poses") return count;
    return std::uint64_t{0};
  };
  // A pose, and a tick once it is there.
  const auto tick = [&](Vec3 tip) {
    const std::uint64_t before = taken();
    client.send_pose(tip);
    while (taken() == before) std::this_thread::yield();
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    virtual_ns += 1000000;
    servo.run(1, never);
    queue.drain(frames);
  };
  const auto silence = [&](int ms) {
    for (int n = 0; n < ms; ++n) {
      virtual_ns += 1000000;
      servo.run(1, never);
    }
    queue.drain(frames);
  };
  for (int n = 0; n < 120; ++n) tick({0, 0, std::max(-1.0, 1 - 0.04 * n)});
  ASSERT_GT(force_of(frames.back()), 0.4);
  silence(45);
  EXPECT_EQ(frames.back().faults, 0u);
  silence(30);
  EXPECT_EQ(frames.back().faults, haptics::haptic_fault::gap);
  EXPECT_EQ(force_of(frames.back()), 0);
  EXPECT_EQ(frames.back().buttons & 1, 0u) << "nothing drills meanwhile";
  const std::size_t back = frames.size();
  for (int n = 0; n < 150; ++n) tick({0, 0, -1});
  for (std::size_t n = back; n < frames.size(); ++n) {
    EXPECT_EQ(frames[n].faults, 0u) << n - back;
    EXPECT_LE(force_of(frames[n]), 0.5 * 0.01 * double(n - back + 2)) << n - back;
  }
  EXPECT_GT(force_of(frames.back()), 0.45);
  EXPECT_LT(force_of(frames[back + 50]), 0.3);
  silence(200);
  tick({0, 0, -1});
  EXPECT_EQ(port.gaps(), 2u);
  std::map<std::string, std::uint64_t> counts;
  for (const auto& [name, count] : device.counts()) counts[name] = count;
  EXPECT_EQ(counts["gaps"], 2u);
  EXPECT_EQ(differing(floor, frames, {}), 0);
  // Longer than it may be: lost for good.
  virtual_ns += std::int64_t(1e9 * params.resume_s);
  silence(60);
  tick({0, 0, -1});
  EXPECT_EQ(frames.back().faults, haptics::haptic_fault::device_lost);
  EXPECT_EQ(force_of(frames.back()), 0);
}
