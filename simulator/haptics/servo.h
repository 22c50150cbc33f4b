// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

#include "base/params.h"
#include "device/device.h"
#include "haptics/device_port.h"
#include "haptics/drilling.h"
#include "haptics/frame.h"
#include "haptics/histogram.h"
#include "haptics/proxy.h"
#include "haptics/tool_belt.h"

namespace trephine::haptics {

struct ServoParams {
  double rate_hz = 1000;
  bool realtime = true, paced = true;
  template <class V>
  static void describe(V& v) {
    using P = ServoParams;
    v.number(&P::rate_hz, "rate_hz", Range{50, 20000}, "Ticks in each second.");
    v.flag(&P::realtime, "realtime", "Ask for SCHED_FIFO and locked memory.");
    v.flag(&P::paced, "paced", "Keep to the clock; without it, run as fast as possible, in the device's own time.");
  }
};

/// What the system granted, with a reason for each request that it refused.
struct RealtimeGrant {
  bool fifo = false, locked = false;
  std::string fifo_fault, lock_fault;
};
/// Locks the process's memory and puts the calling thread under SCHED_FIFO.
RealtimeGrant claim_realtime();

/// How late a loop that does nothing but sleep wakes up on this machine, at that rate for that long, under SCHED_FIFO
/// where it is granted. So much of the servo's lateness is the machine's. It runs on a thread of its own.
Histogram bare_loop_lateness(double rate_hz, double seconds, bool realtime);

/// A queue of frames from the servo thread to the thread that writes them: one writer, one reader, no lock. A full
/// queue drops the frame and counts it.
class FrameQueue {
 public:
  explicit FrameQueue(std::size_t capacity);  ///< rounded up to a power of two
  /// The frame, and behind it that of the other hand where there is one: both or none.
  bool push(const ServoFrame& frame, const ServoFrame* second = nullptr);
  /// Appends the waiting frames to `out`, of two hands in turns.
  void drain(std::vector<ServoFrame>& out);
  std::uint64_t dropped() const { return dropped_.load(std::memory_order_relaxed); }

 private:
  std::vector<ServoFrame> frames_;
  std::atomic<std::uint64_t> head_{0}, tail_{0}, dropped_{0};
};

struct ServoStatistics {
  std::uint64_t ticks = 0, overruns = 0;  ///< overruns: ticks that began after the next one was due
  std::uint64_t touching = 0, events[haptic_event::count] = {};
  std::uint32_t faults = 0;
  double most_force_n = 0, most_force_step_n = 0;
  Histogram late, busy;  ///< wake-up after the due time; and from there to the force sent (clock time of the tick)
};

/// The other hand, which the loop serves in each tick.
class OtherHand {
 public:
  virtual ~OtherHand() = default;
  /// Its tick, with the first hand's frame of the same one and its belt after it (null: it has none); what it felt. As
  /// a tick, it neither allocates nor locks.
  virtual const ServoFrame& tick(const ServoFrame& first, const ToolBelt* belt) = 0;
  virtual std::uint32_t faults() const = 0;  ///< so far; other threads may ask
};

/// The servo loop: it reads the device, moves the proxy and sends the force, in the calling thread, until `stop` or
/// `ticks`. Its ticks neither allocate, lock nor write; their one system call is the sleep. A tick that wakes late
/// takes the elapsed time, in whole periods, as its step, and skips the ticks that it missed. A lost device latches a
/// fault: from then on the force is zero.
///
/// Where `drilling` is given, the tool cuts after its force was sent. `queue` may be null. The statistics may be read
/// after the loop has returned.
class Servo {
 public:
  Servo(Proxy& proxy, device::Device& device, const ServoParams& params, FrameQueue* queue,
        Drilling* drilling = nullptr)
      : proxy_(&proxy), device_(device), params_(params), queue_(queue), drilling_(drilling) {}
  /// The same with several tools, and the drill that they have.
  Servo(ToolBelt& belt, device::Device& device, const ServoParams& params, FrameQueue* queue)
      : belt_(&belt), device_(device), params_(params), queue_(queue) {}
  /// What lies between the device and the tool; it must outlive the loop. Without one, a silent device is lost.
  void set_port(DevicePort* port) { port_ = port; }
  /// It is served at the end of each tick, after the first hand's force was sent and its tool has cut: the first hand
  /// waits for nothing, and the two are of the same ticks whatever either device does. It must outlive the loop.
  void set_other(OtherHand* other) { other_ = other; }
  void run(std::uint64_t ticks, const std::atomic<bool>& stop);
  /// One tick of the loop, for a caller who has a clock of his own.
  void tick(double dt_s, double late_ns);
  const ServoStatistics& statistics() const { return statistics_; }
  /// Ticks done and faults latched so far, for another thread to show.
  std::uint64_t ticks_done() const { return done_.load(std::memory_order_relaxed); }
  std::uint32_t faults() const { return faults_.load(std::memory_order_relaxed); }

 private:
  Proxy* proxy_ = nullptr;    // either this
  ToolBelt* belt_ = nullptr;  // or this
  device::Device& device_;
  ServoParams params_;
  FrameQueue* queue_;
  Drilling* drilling_ = nullptr;
  DevicePort* port_ = nullptr;
  OtherHand* other_ = nullptr;
  ServoStatistics statistics_;
  ServoFrame frame_;
  Vec3 last_force_n_;
  std::atomic<std::uint64_t> done_{0};
  std::atomic<std::uint32_t> faults_{0};
};

}  // namespace trephine::haptics
