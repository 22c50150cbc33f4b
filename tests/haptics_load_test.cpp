// SPDX-License-Identifier: GPL-3.0-or-later
// What happens to forces when the machine is busy: overruns (H5), drilling under contact with every core at work (H8).
#include <gtest/gtest.h>
#include <time.h>

#include <chrono>
#include <thread>

#include "device/simulated_hand.h"
#include "haptics/servo.h"
#include "haptics_only_sleep.h"
#include "haptics_scene.h"

using namespace trephine;
using namespace trephine::haptic_scenes;

namespace {

const std::atomic<bool> no_stop{false};

// Goes on at 2 mm/s into the floor; its read takes 20 ms every 50th time.
class SlowDevice : public device::Device {
 public:
  double damping_n_s_per_mm() const override { return 0; }
  bool read(double dt_s, device::DeviceReading& out) override {
    if (++reads_ % 50 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(20));
    z_ -= 2 * dt_s;
    out.tip_mm = {0, 0, z_};
    return true;
  }
  void send(Vec3) override {}

 private:
  int reads_ = 0;
  double z_ = 0.2;
};

double thread_cpu_s() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

}  // namespace

// H5: an overrun is counted, the next tick stands for the time that passed, and the force rises no faster than it may.
TEST(HapticsLoad, AnOverrunIsCountedAndGivesNoJump) {
  voxel::HapticVolume volume = empty(24, {2, 2, 2});
  fill(volume, 1, [](Vec3 p) { return -p.z; });
  const contact::ContactVolume contact(volume);
  haptics::ForceParams force;
  force.ramp_s = 0;
  force.max_force_rate_n_per_s = 20;
  force.max_step_s = 3600;  // a busy machine may stand still for a second
  haptics::Proxy proxy(contact, one_shape(1, face(2), face(1)), force);
  SlowDevice device;
  haptics::FrameQueue queue(1024);
  haptics::ServoParams params;
  params.realtime = false;
  haptics::Servo servo(proxy, device, params, &queue);
  servo.run(400, no_stop);
  std::vector<haptics::ServoFrame> frames;
  queue.drain(frames);
  EXPECT_GE(servo.statistics().overruns, 8u);
  ASSERT_EQ(frames.size(), 400u);
  int long_steps = 0;
  for (std::size_t n = 1; n < frames.size(); ++n) {
    const haptics::ServoFrame &a = frames[n - 1], &b = frames[n];
    EXPECT_EQ(b.faults, 0u);
    // After a late tick the device holds less; from there the force goes on as in one tick.
    const double holds = a.force_n[2] * (b.dt_s > 0.0015 ? device::ForceHold().share(b.dt_s) : 1);
    EXPECT_LE(std::abs(b.force_n[2] - holds), force.force_rate_n_per_s() * 0.001 + 1e-9) << n;
    if (n % 50 == 0) long_steps += b.dt_s > 0.0195;  // the tick after a slow one
  }
  EXPECT_EQ(long_steps, 7);
  EXPECT_GT(frames.back().force_n[2], 0.3);
}

// H8: a floor is drilled away, layer by layer, under a tip that presses on it, until the tip stands on what lies below;
// beside it threads keep every core busy. Lateness is printed and nothing is promised of it.
TEST(HapticsLoad, DrillingThroughUnderContactOnABusyMachine) {
  voxel::HapticVolume volume = empty(40, {0.5, 0.5, 0.5});
  fill(volume, 1, [](Vec3 p) { return std::min(-p.z, p.z + 4); });
  fill(volume, 2, [](Vec3 p) { return -5 - p.z; });
  contact::ContactVolume contact(volume);
  haptics::Feels feels = untouchable();
  feels[1].front = feels[2].front = face(0.8, 0.3, 0.2);
  feels[1].back = feels[2].back = face(0.8);
  haptics::ForceParams force;
  force.max_step_s = 3600;
  haptics::Proxy proxy(contact, feels, force);
  device::HandParams params;
  params.delay_s = 0;
  device::SimulatedHand hand(params, {{0.1, 0.2, 1}, {0.1, 0.2, -7}}, 1);
  constexpr std::uint64_t ticks_most = 1 << 14;
  haptics::FrameQueue queue(ticks_most);
  haptics::ServoParams servo_params;
  servo_params.realtime = false;
  haptics::Servo servo(proxy, hand, servo_params, &queue);

  std::atomic<bool> stop{false};
  std::vector<std::thread> busy;
  for (unsigned n = 0; n < 2 * std::max(1u, std::thread::hardware_concurrency()); ++n)
    busy.emplace_back([&] {
      volatile double x = 1;
      while (!stop) x = x * 1.0000001 + 1e-9;
    });
  double cpu_s = 0;
  std::atomic<bool> rested{false};
  std::thread thread([&] {
    const double begin = thread_cpu_s();
    servo.run(ticks_most, rested);
    cpu_s = thread_cpu_s() - begin;
    stop = true;
  });
  while (servo.ticks_done() < 1000 && !stop) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  grid::Grid<std::int16_t>& v = volume.voxels;
  for (int k = v.size[2] - 1; k >= 0 && !stop; --k) {
    grid::Box layer{{12, 12, k}, {28, 28, k + 1}};
    bool any = false;
    contact.loosen(layer);
    for (int j = layer.begin[1]; j < layer.end[1]; ++j)
      for (int i = layer.begin[0]; i < layer.end[0]; ++i) {
        std::int16_t& voxel = v.at(i, j, k);
        if (voxel / 1000 != 1) continue;
        any = true;
        __atomic_store_n(&voxel, voxel::haptic_empty, __ATOMIC_RELAXED);
      }
    contact.settle({{10, 10, std::max(0, k - 2)}, {30, 30, std::min(v.size[2], k + 3)}});
    // The next layer once the tip had time to follow, in ticks: a busy machine has few of them a second.
    const std::uint64_t until = servo.ticks_done() + (any ? 30 : 0);
    while (servo.ticks_done() < until && !stop) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  const std::uint64_t until = servo.ticks_done() + 2000;
  while (servo.ticks_done() < until && !stop) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  rested = true;
  thread.join();
  for (std::thread& t : busy) t.join();

  std::vector<haptics::ServoFrame> frames;
  queue.drain(frames);
  ASSERT_EQ(frames.size(), servo.ticks_done());
  ASSERT_LT(frames.size(), ticks_most);
  Vec3 last;
  for (const haptics::ServoFrame& f : frames) {
    const Vec3 is{f.force_n[0], f.force_n[1], f.force_n[2]};
    const Vec3 holds = last * (f.dt_s > 0.0015 ? device::ForceHold().share(f.dt_s) : 1);
    EXPECT_LE(norm(is - holds), force.force_rate_n_per_s() * 0.001 + 1e-9) << f.tick;
    EXPECT_EQ(f.faults, 0u);
    EXPECT_GT(f.proxy_mm[2], -5.1) << f.tick << ": through the lower floor";
    EXPECT_TRUE(f.tip_mm[2] > -5.1 || f.touched != 0) << f.tick << ": a contact was missed";
    last = is;
  }
  EXPECT_EQ(frames.back().touched, 2);
  EXPECT_NEAR(frames.back().proxy_mm[2], -5, 0.1);
  EXPECT_EQ(frames[999].touched, 1);
  const haptics::ServoStatistics& s = servo.statistics();
  std::printf("  CPU time a tick, with the hand's: %.1f us; woken late p50 %.0f, p99 %.0f, p99.9 %.0f us\n",
              1e6 * cpu_s / double(frames.size()), s.late.quantile_ns(0.5) / 1e3, s.late.quantile_ns(0.99) / 1e3,
              s.late.quantile_ns(0.999) / 1e3);
  if (!sanitized) {
    EXPECT_LT(cpu_s / double(frames.size()), 500e-6);
  }
}
