// SPDX-License-Identifier: GPL-3.0-or-later
#include "peers/experiment.h"

#include <time.h>

#include <algorithm>
#include <cmath>

#include "base/rank.h"
#include "base/splitmix64.h"

namespace trephine::peers {
namespace {

double cpu_us() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e6 * double(t.tv_sec) + 1e-3 * double(t.tv_nsec);
}

double clock_cost_us() {
  std::vector<double> v(2001);
  for (double& d : v) {
    const double begin = cpu_us();
    d = cpu_us() - begin;
  }
  return median_of(v);
}

// A device that goes along a path at an even pace, and around its loop.
class Walker {
 public:
  Walker(const device::HandPath& path, double mm_a_tick) : path_(path), step_(mm_a_tick), at_(path.points_mm[0]) {}
  Vec3 next() {
    for (double left = step_; left > 0 && path_.points_mm.size() > 1;) {
      const Vec3 way = path_.points_mm[to_] - at_;
      const double length = norm(way);
      if (length > left) {
        at_ += way * (left / length);
        break;
      }
      at_ = path_.points_mm[to_];
      left -= length;
      if (++to_ == path_.points_mm.size()) {
        to_ = std::min(path_.loop_from, path_.points_mm.size() - 1);
        if (length == 0 && left == step_) break;  // a loop of one place
      }
    }
    return at_;
  }

 private:
  const device::HandPath& path_;
  double step_;
  Vec3 at_;
  std::size_t to_ = 1;
};

haptics::HapticInput input_at(Vec3 device_mm) {
  haptics::HapticInput in;
  in.tip_mm = device_mm;
  in.dt_s = in.period_s = tick_s;
  return in;
}

void limit(haptics::HapticState& state) {
  const double force = norm(state.force_n);
  if (!(force <= device_most_n)) state.force_n = force > 0 ? state.force_n * (device_most_n / force) : Vec3{};
}

Vec3 vec(const double* v) { return {v[0], v[1], v[2]}; }

}  // namespace

TickTimes measure_ticks(ContactAlgorithm& algorithm, const device::HandPath& path, double mm_a_tick, int ticks) {
  const double cost = clock_cost_us();
  Walker walker(path, mm_a_tick);
  algorithm.reset();
  TickTimes out;
  out.sorted_us.reserve(std::size_t(ticks));
  int touching = 0;
  bool met = false;
  // What never touches is measured as well, from the time at which the path has reached its loop.
  const double approach = path.points_mm.size() > 1 ? norm(path.points_mm[1] - path.points_mm[0]) : 0;
  const auto begins = std::int64_t(approach / mm_a_tick) + 1;
  for (std::int64_t n = 0; out.sorted_us.size() < std::size_t(ticks); ++n) {
    const haptics::HapticInput in = input_at(walker.next());
    if (n % ticks_a_picture == 0) algorithm.client(in.tip_mm);
    const double begin = cpu_us();
    const haptics::HapticState& state = algorithm.update(in);
    const double t = cpu_us() - begin - cost;
    met = met || state.touched != 0;
    if (n < begins || (!met && n < 2 * begins)) continue;
    out.sorted_us.push_back(std::max(0.0, t));
    touching += state.touched != 0;
  }
  for (const double t : out.sorted_us) out.mean_us += t / ticks;
  std::sort(out.sorted_us.begin(), out.sorted_us.end());
  const auto at = [&](double share) {
    return out.sorted_us[std::min(out.sorted_us.size() - 1, std::size_t(share * double(ticks)))];
  };
  out.median_us = at(0.5);
  out.p99_us = at(0.99);
  out.most_us = out.sorted_us.back();
  out.touching_ratio = double(touching) / ticks;
  return out;
}

double measure_client_ms(ContactAlgorithm& algorithm, const device::HandPath& path, double mm_a_tick, int pictures) {
  Walker walker(path, mm_a_tick);
  algorithm.reset();
  const double approach = path.points_mm.size() > 1 ? norm(path.points_mm[1] - path.points_mm[0]) : 0;
  const auto begins = std::int64_t(approach / mm_a_tick) / ticks_a_picture + 2;
  double sum = 0;
  for (std::int64_t picture = 0; picture < begins + pictures; ++picture)
    for (int n = 0; n < ticks_a_picture; ++n) {
      const haptics::HapticInput in = input_at(walker.next());
      if (n == 0) {
        const double begin = cpu_us();
        algorithm.client(in.tip_mm);
        if (picture >= begins) sum += cpu_us() - begin;
      }
      algorithm.update(in);
    }
  return sum / pictures / 1000;
}

VariedHand varied_hand(int number, const device::HandPathParams& path) {
  VariedHand out{{}, path};
  if (number == 0) return out;
  std::uint64_t count = 64 * std::uint64_t(number);
  const auto between = [&](double low, double high) {
    return low + (high - low) * unit_of_bits(splitmix64_mixed(++count * splitmix64_step));
  };
  out.hand.mass_kg = between(0.1, 0.35);
  out.hand.arm_stiffness_n_per_mm = between(0.2, 0.7);
  out.hand.arm_damping_n_s_per_mm = between(0.003, 0.008);
  out.hand.delay_s = between(0.05, 0.2);
  out.hand.tremor_mm = between(0.01, 0.06);
  out.hand.tremor_hz = between(7, 12);
  out.hand.speed_mm_per_s = between(10, 40);
  out.path.radius_mm = path.radius_mm * between(0.6, 1.4);
  out.path.depth_mm = path.depth_mm * between(0.7, 2);
  return out;
}

std::vector<haptics::ServoFrame> run_closed(ContactAlgorithm& algorithm, const device::HandParams& params,
                                            const device::HandPath& path, double seconds) {
  device::SimulatedHand hand(params, path.points_mm, path.loop_from);
  hand.axis = path.axis;
  algorithm.reset();
  std::vector<haptics::ServoFrame> frames(std::size_t(std::llround(seconds / tick_s)));
  for (std::size_t n = 0; n < frames.size(); ++n) {
    device::DeviceReading reading;
    hand.read(tick_s, reading);
    haptics::HapticInput in = input_at(reading.tip_mm);
    in.axis = reading.axis;
    if (n % ticks_a_picture == 0) algorithm.client(in.tip_mm);
    haptics::HapticState state = algorithm.update(in);
    limit(state);
    hand.send(state.force_n);
    frames[n].tick = n;
    frames[n].time_s = double(n + 1) * tick_s;
    frames[n].dt_s = tick_s;
    haptics::put_input(in, frames[n]);
    haptics::put_answer(state, frames[n]);
  }
  return frames;
}

std::vector<haptics::ServoFrame> run_open(ContactAlgorithm& algorithm, const std::vector<haptics::ServoFrame>& poses) {
  algorithm.reset();
  std::vector<haptics::ServoFrame> frames = poses;
  for (std::size_t n = 0; n < frames.size(); ++n) {
    const haptics::HapticInput in = haptics::input_of(poses[n], 1 / tick_s);
    if (n % ticks_a_picture == 0) algorithm.client(in.tip_mm);
    haptics::HapticState state = algorithm.update(in);
    limit(state);
    haptics::put_answer(state, frames[n]);
  }
  return frames;
}

RunFigures judge(const std::vector<haptics::ServoFrame>& frames, const PeerScene& truth) {
  RunFigures out;
  session::ForceWindow window = session::force_window(frames);
  if (window.begin >= window.end) window = {frames.size() / 2, frames.size()};  // it never touched, which is the worst
  out.force = session::force_figures(frames, window);
  bool fell = false;
  std::size_t fallen = 0;
  for (std::size_t n = window.begin; n < window.end; ++n) {
    const Vec3 device = vec(frames[n].tip_mm);
    const bool falls = vec(frames[n].force_n) == Vec3{} && truth.contact->shape_at(device) == truth.shape &&
                       !truth.mesh->nearest(device - truth.mesh->mesh().origin_mm, fall_mm);
    out.falls += falls && !fell;
    fallen += falls;
    fell = falls;
  }
  if (window.end > window.begin) out.fallen_ratio = double(fallen) / double(window.end - window.begin);
  return out;
}

}  // namespace trephine::peers
