// SPDX-License-Identifier: GPL-3.0-or-later
#include "haptics/servo.h"

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <time.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <thread>

#include "haptics/recording.h"

namespace trephine::haptics {
namespace {

constexpr std::int64_t second_ns = 1000000000;

std::int64_t now_ns() {
  timespec t{};
  clock_gettime(CLOCK_MONOTONIC, &t);  // read in user space (vDSO)
  return t.tv_sec * second_ns + t.tv_nsec;
}

void sleep_until(std::int64_t ns) {
  const timespec t{time_t(ns / second_ns), long(ns % second_ns)};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &t, nullptr) == EINTR) {
  }
}

// Touches the stack that the loop may use, so that no page of it is missing when the loop gets there.
void touch_stack() {
  volatile char bytes[256 * 1024];
  for (std::size_t n = 0; n < sizeof bytes; n += 1024) bytes[n] = 0;
}

}  // namespace

RealtimeGrant claim_realtime() {
  RealtimeGrant g;
  g.locked = mlockall(MCL_CURRENT | MCL_FUTURE) == 0;
  if (!g.locked) g.lock_fault = std::strerror(errno);
  sched_param p{};
  p.sched_priority = 80;
  const int fault = pthread_setschedparam(pthread_self(), SCHED_FIFO, &p);
  g.fifo = fault == 0;
  if (fault != 0) g.fifo_fault = std::strerror(fault);
  return g;
}

Histogram bare_loop_lateness(double rate_hz, double seconds, bool realtime) {
  Histogram late;
  std::thread loop([&] {
    if (realtime) claim_realtime();
    const std::int64_t period = std::int64_t(std::llround(1e9 / rate_hz));
    std::int64_t due = now_ns() + period;
    for (std::int64_t n = 0; n < std::llround(seconds * rate_hz); ++n, due += period) {
      sleep_until(due);
      const std::int64_t woke = now_ns();
      late.add(double(woke - due));
      due += std::max<std::int64_t>(0, (woke - due) / period) * period;  // what was missed is not made up for
    }
  });
  loop.join();
  return late;
}

FrameQueue::FrameQueue(std::size_t capacity) {
  std::size_t n = 64;
  while (n < capacity) n *= 2;
  frames_.resize(n);
}

bool FrameQueue::push(const ServoFrame& frame, const ServoFrame* second) {
  const std::uint64_t head = head_.load(std::memory_order_relaxed), count = second ? 2 : 1;
  if (head - tail_.load(std::memory_order_acquire) + count > frames_.size()) {
    dropped_.fetch_add(1, std::memory_order_relaxed);
    return false;
  }
  frames_[head & (frames_.size() - 1)] = frame;
  if (second) frames_[(head + 1) & (frames_.size() - 1)] = *second;
  head_.store(head + count, std::memory_order_release);
  return true;
}

void FrameQueue::drain(std::vector<ServoFrame>& out) {
  std::uint64_t tail = tail_.load(std::memory_order_relaxed);
  const std::uint64_t head = head_.load(std::memory_order_acquire);
  for (; tail != head; ++tail) out.push_back(frames_[tail & (frames_.size() - 1)]);
  tail_.store(tail, std::memory_order_release);
}

void Servo::tick(double dt_s, double late_ns) {
  device::DeviceReading reading;
  const bool there = device_.read(frame_.tick == 0 ? 0 : dt_s, reading);
  HapticInput in;
  in.tip_mm = reading.tip_mm;
  in.axis = reading.axis;
  if (device_.knows_across()) in.across = reading.across;  // only then does a recording hold it
  in.buttons = reading.buttons;
  in.dt_s = dt_s;
  in.period_s = 1 / params_.rate_hz;
  if (drilling_) drilling_->prepare(in);
  if (port_) port_->before(in, there && reading.silent);
  if (!there || (reading.silent && !port_))
    belt_ ? belt_->latch(haptic_fault::device_lost) : proxy_->latch(haptic_fault::device_lost);
  const HapticState& felt = belt_ ? belt_->update(in) : proxy_->update(in);
  const HapticState& s = port_ ? port_->after(in, felt) : felt;
  device_.tell({frame_.time_s + dt_s, s.proxy_mm, s.touched, s.inside, s.faults, s.torque_n_mm, s.axis, s.across,
                s.events, s.locked, belt_ ? belt_->in_hand() : 0});
  device_.send(s.force_n);
  if (drilling_) drilling_->tick(in, s);
  if (belt_) belt_->after(in, s);

  ServoStatistics& c = statistics_;
  ++c.ticks;
  c.touching += s.touched != 0;
  for (int n = 0; n < haptic_event::count; ++n) c.events[n] += s.events >> n & 1;
  c.faults |= s.faults;
  c.most_force_n = std::max(c.most_force_n, norm(s.force_n));
  c.most_force_step_n = std::max(c.most_force_step_n, norm(s.force_n - last_force_n_));
  last_force_n_ = s.force_n;
  frame_.dt_s = dt_s;
  frame_.time_s += dt_s;
  if (queue_ || other_) {
    ServoFrame& f = frame_;
    put_input(in, f);
    put_answer(s, f);
    f.late_us = std::uint32_t(std::min(late_ns / 1000, 4e9));
    const ServoFrame* second = other_ ? &other_->tick(f, belt_) : nullptr;
    if (queue_) queue_->push(f, second);
  }
  ++frame_.tick;
  done_.store(frame_.tick, std::memory_order_relaxed);
  faults_.store(c.faults, std::memory_order_relaxed);
}

void Servo::run(std::uint64_t ticks, const std::atomic<bool>& stop) {
  touch_stack();
  const std::int64_t period = std::int64_t(std::llround(1e9 / params_.rate_hz));
  std::int64_t due = now_ns() + period;
  std::int64_t periods = 1;
  for (std::uint64_t n = 0; n < ticks && !stop.load(std::memory_order_relaxed); ++n) {
    std::int64_t woke = due;
    if (params_.paced) {
      sleep_until(due);
      woke = now_ns();
      statistics_.late.add(double(woke - due));
    } else {
      woke = now_ns();
    }
    tick(double(periods) / params_.rate_hz, params_.paced ? double(woke - due) : 0);
    const std::int64_t end = now_ns();
    statistics_.busy.add(double(end - woke));
    if (!params_.paced) continue;
    due += period;
    periods = 1;
    if (end <= due) continue;
    ++statistics_.overruns;
    periods += (end - due) / period;
    due += (periods - 1) * period;
  }
}

}  // namespace trephine::haptics
