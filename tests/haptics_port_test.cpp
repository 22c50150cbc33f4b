// SPDX-License-Identifier: GPL-3.0-or-later
// What lies between a device and the tool: jumps, gaps, and the energy that a delay would give.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <map>
#include <thread>

#include "device/simulated_hand.h"
#include "device/udp_device.h"
#include "device_udp_client.h"
#include "haptics/recording.h"
#include "haptics/servo.h"
#include "haptics_scene.h"

using namespace trephine;
using namespace trephine::haptic_scenes;
using walls::uniform;

namespace {

const std::atomic<bool> never{false};

haptics::ForceParams device_limits() {
  haptics::ForceParams p;
  p.ramp_s = 0.05;
  return p;
}
haptics::ServoParams unpaced() {
  haptics::ServoParams p;
  p.paced = p.realtime = false;
  return p;
}

// A floor below z = 0, and a servo over it that is run by the test.
struct Floor {
  voxel::HapticVolume volume = empty(60, {2, 2, 2});
  haptics::Feels feels = one_shape(1, face(0.5), face(0.5));
  std::unique_ptr<contact::ContactVolume> contact;
  explicit Floor(double stiffness = 0.5, double friction = 0)
      : feels(one_shape(1, face(stiffness, friction, friction), face(stiffness))) {
    fill(volume, 1, [](Vec3 p) { return -p.z; });
    contact = std::make_unique<contact::ContactVolume>(volume);
  }
};

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

// ---------------------------------------------------------------------------------------------------------- energy

namespace {

constexpr int fine = 4;  // places of a path in a tick of 1 ms

// A closed way into the wall and out: along straight lines with sudden turns, or as a hand moves, with rests.
std::vector<Vec3> closed_path(std::mt19937_64& rng) {
  std::vector<Vec3> path;
  Vec3 at{0.2, 0.1, 2};
  const bool sudden = rng() % 2;
  const double speed = std::pow(10.0, uniform(rng, -1.7, 0.3)), quick = std::pow(10.0, uniform(rng, 0.7, 2.17));
  const double dt_ms = 1.0 / fine;
  const auto go = [&](Vec3 to) {
    const double way = norm(to - at);  // mm; m/s are mm/ms
    double ms = way / speed;
    if (!sudden) ms = std::max(1.875 * ms, std::sqrt(5.78 * way / (1e-3 * quick)));
    const int steps = std::max(1, int(std::ceil(ms / dt_ms)));
    for (int n = 1; n <= steps; ++n) {
      const double t = double(n) / steps;
      path.push_back(at + (to - at) * (sudden ? t : t * t * t * (10 - 15 * t + 6 * t * t)));
    }
    at = to;
    if (rng() % 3 == 0) path.insert(path.end(), std::size_t(uniform(rng, 0, 100) * fine), at);
  };
  const Vec3 begin = at;
  path.push_back(at);
  for (int n = 1 + int(rng() % 6); n > 0; --n) {
    go({uniform(rng, -6, 6), uniform(rng, -6, 6), -std::pow(10.0, uniform(rng, -1, 0.78))});
    if (rng() % 2) go({uniform(rng, -6, 6), uniform(rng, -6, 6), uniform(rng, 0.2, 3)});
  }
  go(begin);
  path.insert(path.end(), 40 * fine, at);  // until the last force has acted
  return path;
}

struct Given {
  double mj = 0, damped_mj = 0;  // on the hand, over the whole way; less what the device's own damping takes
};

// The energy at the device: each force acts for a tick, `delay` places of the path after the pose that it answers.
Given follow(const Floor& floor, const std::vector<Vec3>& path, int delay, const haptics::PortParams& params,
             const haptics::ForceParams& limits) {
  haptics::Proxy proxy(*floor.contact, floor.feels, limits);
  haptics::DevicePort port(params, limits);
  Given e;
  const int seen_late = delay / 2, felt_late = delay - seen_late, last = int(path.size()) - 1;
  const auto place = [&](int n) { return path[std::size_t(std::clamp(n, 0, last))]; };
  for (int n = 0; n + fine + felt_late <= last; n += fine) {
    haptics::HapticInput in = at(place(n - seen_late));
    in.period_s = 0.001;
    port.before(in, false);
    const Vec3 force = port.after(in, proxy.update(in)).force_n;
    for (int part = 0; part < fine; ++part) {
      const Vec3 d = place(n + part + 1 + felt_late) - place(n + part + felt_late);
      e.mj += dot(force, d);
      e.damped_mj += dot(force, d) - 0.002 * dot(d, d) * 1000 * fine;
    }
  }
  return e;
}

// How deep 3 N are felt by a hand that presses with 20 mm/s.
double depth_of_3_n(const Floor& floor, int delay, const haptics::PortParams& params) {
  haptics::Proxy proxy(*floor.contact, floor.feels, plain());
  haptics::DevicePort port(params, plain());
  for (int n = 0; n < 2000; ++n) {
    haptics::HapticInput in = at({0.2, 0.1, 1 - 0.02 * n});
    in.period_s = 0.001;
    port.before(in, false);
    if (norm(port.after(in, proxy.update(in)).force_n) >= 3) return -in.tip_mm.z + 0.02 * delay / fine;
  }
  return 1e9;
}

/// So many random closed paths at each stiffness and delay.
void check_closed_paths(int paths_count) {
  std::printf(
      "  N/mm  delay ms  worst mJ without, damped, with the controller, damped; 3 N felt at mm: without, with\n");
  for (const auto& [stiffness, friction] : {std::pair{3.2, 0.0}, {3.2, 0.3}, {1.0, 0.3}, {0.3, 0.0}}) {
    const Floor floor(stiffness, friction);
    double worst_without = 0;
    for (const double delay_ms : {0.0, 0.5, 1.0, 2.0, 3.0, 5.0}) {
      std::mt19937_64 rng(31);
      const int delay = int(delay_ms * fine);
      haptics::PortParams with, without;
      with.device_delay_ms = delay_ms;
      Given most{-1e9, -1e9}, max_without{-1e9, -1e9};
      for (int n = 0; n < paths_count; ++n) {
        const std::vector<Vec3> path = closed_path(rng);
        const haptics::ForceParams limits = n % 4 == 0 ? plain() : device_limits();
        const Given a = follow(floor, path, delay, with, limits), b = follow(floor, path, delay, without, limits);
        if (delay == 0) {
          ASSERT_EQ(a.mj, b.mj) << n;
        }
        most.mj = std::max(most.mj, a.mj);
        most.damped_mj = std::max(most.damped_mj, a.damped_mj);
        max_without.mj = std::max(max_without.mj, b.mj);
        max_without.damped_mj = std::max(max_without.damped_mj, b.damped_mj);
      }
      std::printf("  %4.1f %s  %4.1f   %8.3f  %8.3f  %8.3f  %8.3f  %5.2f  %5.2f\n", stiffness, friction > 0 ? "f" : " ",
                  delay_ms, max_without.mj, max_without.damped_mj, most.mj, most.damped_mj,
                  depth_of_3_n(floor, delay, without), depth_of_3_n(floor, delay, with));
      EXPECT_LE(delay == 0 ? most.damped_mj : most.mj, 1.0) << stiffness << " N/mm, " << delay_ms << " ms";
      worst_without = std::max(worst_without, max_without.mj);
    }
    EXPECT_GT(worst_without, 10) << "the paths were too tame to show anything";
  }
}

}  // namespace

TEST(HapticsPassivity, ADelayGivesNoEnergyOverClosedPaths) { check_closed_paths(100); }
TEST(LongHapticsPassivity, ADelayGivesNoEnergyOverClosedPaths) { check_closed_paths(1000); }

// A hand with a mass presses on a wall through a device whose forces come late.
TEST(HapticsPassivity, AHandBehindADelayDoesNotSwingUp) {
  std::printf("  delay ms  swing in the last second mm: without, with the controller; force N: without, with\n");
  const Floor floor(3.2);
  for (const int delay_ms : {1, 3, 5}) {
    double swing[2], force_n[2];
    for (const bool controlled : {false, true}) {
      device::HandParams h;
      h.tremor_mm = h.delay_s = 0;
      h.arm_stiffness_n_per_mm = 0.3;
      device::SimulatedHand hand(h, {{0.2, 0.1, 1}, {0.2, 0.1, -8}}, 1);
      haptics::PortParams params;
      params.device_delay_ms = controlled ? delay_ms : 0;
      haptics::Proxy proxy(*floor.contact, floor.feels, device_limits());
      haptics::DevicePort port(params, device_limits());
      std::vector<Vec3> late(std::size_t(delay_ms), Vec3{});
      double low = 1e9, high = -1e9, sum = 0;
      for (int n = 0; n < 5000; ++n) {
        device::DeviceReading r;
        hand.read(n == 0 ? 0 : 0.001, r);
        haptics::HapticInput in = at(r.tip_mm);
        in.period_s = 0.001;
        port.before(in, false);
        Vec3& slot = late[std::size_t(n % delay_ms)];
        hand.send(slot);
        slot = port.after(in, proxy.update(in)).force_n;
        if (n < 4000) continue;
        low = std::min(low, r.tip_mm.z);
        high = std::max(high, r.tip_mm.z);
        sum += slot.z / 1000;
      }
      swing[controlled] = high - low;
      force_n[controlled] = sum;
    }
    std::printf("  %5d     %6.3f  %6.3f   %5.2f  %5.2f\n", delay_ms, swing[0], swing[1], force_n[0], force_n[1]);
    if (delay_ms > 1) {
      EXPECT_GT(swing[0], 2) << "nothing to be shown";
    }
    EXPECT_LT(swing[1], 0.2) << delay_ms;
    EXPECT_GT(force_n[1], 1.4) << delay_ms << ": the wall is still there";
  }
}
