// SPDX-License-Identifier: GPL-3.0-or-later
#include "session/calibration.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>
#include <vector>

#include "base/error.h"
#include "base/rank.h"
#include "surface/bounds.h"

namespace trephine::session {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double near_mm = 0.05, far_mm = 0.2;  // ways of a pulse: four times the way takes twice the time
constexpr double max_pulse_s = 0.06, rest_s = 0.4;
constexpr double bite_mm = 0.3;         // how far within the wall the hand is at its begin
constexpr double at_rest_mm_per_s = 3;  // RMS over the last third of a wall
constexpr double given_j = 2e-4;        // energy that noise may seem to give
constexpr int pulses = 9;
constexpr double min_pressed = 0.2;  // share of a wall's time; a wall that was touched for less was not pressed
constexpr int max_tries = 3;         // of a wall that nobody presses

class Hand {
 public:
  Hand(device::Device& device, const CalibrationParams& p, const std::atomic<bool>& stop)
      : device_(device), p_(p), stop_(stop), due_(Clock::now()), dt_s_(1 / p.calibration_hz) {}

  double dt_s() const { return dt_s_; }
  Vec3 at_mm() const { return at_; }

  // One tick: waits for its time, reads, and sends what `force` makes of the place.
  template <class Force>
  void tick(const Force& force) {
    if (stop_.load(std::memory_order_relaxed)) {
      device_.send({});
      throw Cancelled();
    }
    if (p_.in_real_time) {
      due_ += std::chrono::nanoseconds(std::llround(1e9 * dt_s_));
      if (Clock::now() > due_ + std::chrono::milliseconds(5)) due_ = Clock::now();  // a stall is not made up for
      std::this_thread::sleep_until(due_);
    }
    device::DeviceReading r;
    const bool there = device_.read(begun_ ? dt_s_ : 0, r);
    begun_ = true;
    if (!there || !is_finite(r.tip_mm)) {
      device_.send({});
      throw Error(ExitCode::io, "", "device", "is lost");
    }
    at_ = r.tip_mm;
    device::DeviceNews news;
    news.time_s = time_s_ += dt_s_;
    news.proxy_mm = at_;
    device_.tell(news);
    device_.send(force(at_));
  }
  void rest(double seconds) {
    for (double t = 0; t < seconds; t += dt_s_) tick([](Vec3) { return Vec3(); });
  }

 private:
  device::Device& device_;
  const CalibrationParams& p_;
  const std::atomic<bool>& stop_;
  Clock::time_point due_;
  double dt_s_, time_s_ = 0;
  Vec3 at_;
  bool begun_ = false;
};

void measure_workspace(Hand& hand, double seconds, Calibration& out) {
  std::vector<double> gaps_ms;
  Vec3 last{1e300, 0, 0};
  double since_ms = 0;
  for (double t = 0; t < seconds; t += hand.dt_s()) {
    hand.tick([](Vec3) { return Vec3(); });
    since_ms += 1000 * hand.dt_s();
    surface::include(out.workspace, hand.at_mm());
    if (hand.at_mm() == last) continue;
    if (last.x < 1e300) gaps_ms.push_back(since_ms);
    last = hand.at_mm();
    since_ms = 0;
  }
  if (gaps_ms.size() < 2) return;
  std::sort(gaps_ms.begin(), gaps_ms.end());
  out.poses_hz = 1000 / gaps_ms[gaps_ms.size() / 2];
  out.gap_p99_ms = gaps_ms[std::size_t(0.99 * double(gaps_ms.size() - 1))];
}

// Under a constant force the way of a mass grows with the square of the time since the motion began. So four times the
// way takes twice the time; subtracting that from the time since the force was sent leaves the latency.
double measure_latency(Hand& hand, double pulse_n) {
  std::vector<double> found_ms;
  for (int n = 0; n < pulses; ++n) {
    hand.rest(rest_s);
    const Vec3 begin = hand.at_mm(), force{0, 0, n % 2 == 0 ? pulse_n : -pulse_n};
    double near_ms = -1, far_ms = -1, t_ms = 0, before_mm = 0;
    while (t_ms < 1000 * max_pulse_s && far_ms < 0) {
      hand.tick([&](Vec3) { return force; });
      const double way_mm = dot(hand.at_mm() - begin, force) / pulse_n;
      // Between two ticks the way is taken as straight.
      const auto when = [&](double mm) {
        return t_ms - 1000 * hand.dt_s() * (1 - std::clamp((mm - before_mm) / (way_mm - before_mm), 0.0, 1.0));
      };
      if (near_ms < 0 && way_mm >= near_mm) near_ms = when(near_mm);
      if (way_mm >= far_mm) far_ms = when(far_mm);
      before_mm = way_mm;
      t_ms += 1000 * hand.dt_s();
    }
    if (far_ms > 0) found_ms.push_back(2 * near_ms - far_ms);
  }
  hand.rest(rest_s);
  return found_ms.size() * 2 > pulses ? std::max(0.0, median_of(found_ms)) : -1;
}

enum class Wall { stable, unstable, unpressed };

Wall press_wall(Hand& hand, const CalibrationParams& p, double stiffness, double floor_mm) {
  const double first_n = std::min(stiffness * (floor_mm - hand.at_mm().z), p.wall_most_n);
  const double held_j = first_n * first_n / (2000 * stiffness);
  double work_j = 0, last_mm = hand.at_mm().z, pressed_n = 0, sum = 0;
  int counted = 0, pressed = 0, ticks = 0;
  for (double t = 0; t < p.wall_s; t += hand.dt_s()) {
    hand.tick([&](Vec3 at) {
      work_j += pressed_n * (at.z - last_mm) / 1000;  // the work of the wall's last force
      ++ticks;
      pressed += pressed_n > 0;
      // Where nobody presses the wall, being at rest says nothing of it.
      if (t > p.wall_s * 2 / 3 && pressed_n > 0) {
        const double speed = (at.z - last_mm) / hand.dt_s();
        sum += speed * speed;
        ++counted;
      }
      last_mm = at.z;
      pressed_n = std::clamp(stiffness * (floor_mm - at.z), 0.0, p.wall_most_n);
      return Vec3{0, 0, pressed_n};
    });
  }
  // The spring held energy at the begin, which it gives back, and holds energy at the end, which the hand gave it.
  const double stored_j = pressed_n * pressed_n / (2000 * stiffness);
  if (work_j > given_j + held_j - stored_j) return Wall::unstable;
  if (counted == 0 || pressed < min_pressed * ticks) return Wall::unpressed;
  return std::sqrt(sum / counted) < at_rest_mm_per_s ? Wall::stable : Wall::unstable;
}

}  // namespace

Calibration calibrate(device::Device& device, const CalibrationParams& p, const std::atomic<bool>& stop,
                      const std::function<void(const std::string&)>& say) {
  Calibration out;
  Hand hand(device, p, stop);
  say("lead the device through its whole workspace");
  measure_workspace(hand, p.workspace_s, out);
  say("hold it loosely and still: short pulses measure the latency");
  out.latency_ms = measure_latency(hand, p.pulse_n);
  say("press it gently and steadily down: walls become stiffer until it trembles");
  for (double k = p.first_stiffness_n_per_mm; k <= p.last_stiffness_n_per_mm * (1 + 1e-9); k *= 1.125) {
    Wall wall = Wall::unpressed;
    for (int n = 0; n < max_tries && wall == Wall::unpressed; ++n) {
      if (n > 0) say("the wall was not pressed: press it down, gently and steadily");
      hand.rest(rest_s);
      wall = press_wall(hand, p, k, hand.at_mm().z + bite_mm);
    }
    if (wall == Wall::stable) {
      out.stable_n_per_mm = k;
      continue;
    }
    (wall == Wall::unstable ? out.unstable_n_per_mm : out.unpressed_n_per_mm) = k;
    break;
  }
  hand.rest(hand.dt_s());
  return out;
}

}  // namespace trephine::session
