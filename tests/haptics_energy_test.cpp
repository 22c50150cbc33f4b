// SPDX-License-Identifier: GPL-3.0-or-later
// The energy that a delay would give to the hand.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "device/simulated_hand.h"
#include "haptics/delayed_walls.h"
#include "haptics_floor.h"

using namespace trephine;
using namespace trephine::haptic_scenes;
using walls::uniform;

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
  // A wall that rises with the force's ramp while the tool is in it gives what the rise adds: once, after the start.
  const Vec3 begin = at;
  path.assign(std::size_t(1200 * device_limits().ramp_s) * fine, at);
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
  const double damping = params.bounds_walls() ? params.device_own_damping_n_s_per_mm : 0.002;
  haptics::Proxy proxy(*floor.contact, haptics::feels_behind(floor.feels, {}, params, 1000), limits);
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
      e.damped_mj += dot(force, d) - damping * dot(d, d) * 1000 * fine;
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
    EXPECT_GT(worst_without, 5) << "the paths were too tame to show anything";
  }
}

}  // namespace

TEST(HapticsPassivity, ADelayGivesNoEnergyOverClosedPaths) { check_closed_paths(100); }
TEST(LongHapticsPassivity, ADelayGivesNoEnergyOverClosedPaths) { check_closed_paths(1000); }

// Where the damping of the device is known, what it takes is more than what a wall of the allowed stiffness gives.
void check_damped_paths(int paths_count) {
  std::printf("  N s/m  delay ms  stiffness ratio, worst mJ less what the device takes\n");
  for (const double friction : {0.0, 0.3})
    for (const double damping : {0.0005, 0.002, 0.006})
      for (const double delay_ms : {0.5, 1.0, 2.0, 3.0, 5.0}) {
        const Floor floor(3.2, friction);
        haptics::PortParams params;
        params.device_delay_ms = delay_ms;
        params.device_own_damping_n_s_per_mm = damping;
        std::mt19937_64 rng(77);
        double most_mj = -1e9;
        for (int n = 0; n < paths_count; ++n)
          most_mj = std::max(most_mj, follow(floor, closed_path(rng), int(delay_ms * fine), params,
                                             n % 4 == 0 ? plain() : device_limits())
                                          .damped_mj);
        std::printf("  %5.1f  %4.1f  %6.3f  %8.3f\n", 1e3 * damping, delay_ms,
                    haptics::walls_behind(floor.feels, {}, params, 1000).stiffness_ratio, most_mj);
        EXPECT_LE(most_mj, 1.0) << damping << " N s/mm, " << delay_ms << " ms";
      }
}
TEST(HapticsPassivity, ADampedDeviceGivesNoEnergyOverClosedPaths) { check_damped_paths(60); }
TEST(LongHapticsPassivity, ADampedDeviceGivesNoEnergyOverClosedPaths) { check_damped_paths(1000); }

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
