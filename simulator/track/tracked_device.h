// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <atomic>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

#include "device/device.h"
#include "device/mailbox.h"
#include "track/body_watch.h"
#include "track/tracking_file.h"

namespace trephine::track {

/// A real tool as a device: its poses are those that a tracker sees, in the frame of the printed case. It gives no
/// force. While the tracker says nothing new of it, says that it is not well, or sees another tool of the lesson than
/// the one in hand, it is silent: the tool rests where it was. It may come back at any time.
///
/// Between two poses it moves evenly, so that it lags behind the tracker by one of them, and no tick sees a step.
class TrackedDevice : public device::Device {
 public:
  /// Seconds, ascending; asked for by both threads.
  using Clock = std::function<double()>;
  /// `lesson_tools`: the names of the tools in hand, by number; empty: there is one.
  TrackedDevice(Tracking tracking, const std::vector<std::string>& lesson_tools, double lost_s, double late_s,
                Clock clock);
  /// The thread of the messages calls these.
  void take(const IgtlHeader& header, const IgtlContent& content);
  void begin_anew();
  /// Whether a tool was seen; the body of the first one in hand; what came so far, and names of bodies that are others.
  bool seen() const { return seen_; }
  const std::string& first_body() const { return tracking_.tools[std::size_t(body_of_.front())].body; }
  const std::string& reference() const { return tracking_.reference; }
  WatchCounts watched() const;
  std::vector<std::string> strangers() const;

  double damping_n_s_per_mm() const override { return 0; }
  bool read(double dt_s, device::DeviceReading& out) override;
  void send(Vec3) override {}
  void tell(const device::DeviceNews& news) override;
  double place_error_mm() const override { return track::place_error_mm(tracking_); }
  std::vector<std::pair<std::string, std::uint64_t>> counts() const override;

 private:
  struct Pose {
    int tool = -1;
    Vec3 tip_mm, axis{0, 0, 1};
    double at_s = -1e9;
  };
  void found(int tool, const RigidMap& tool_to_reference, double now_s);

  const Tracking tracking_;
  const RigidMap reference_to_case_;
  const std::vector<int> body_of_;  // of the tool in hand, by number
  const double lost_s_;
  const Clock clock_;
  device::Mailbox<Pose> poses_;
  std::atomic<int> wanted_;
  std::atomic<bool> seen_{false};
  std::atomic<double> unwell_s_{-1e9};
  mutable std::mutex watching_;
  BodyWatch watch_;
  // The servo thread's.
  Pose newest_, from_;
  Vec3 shown_mm_, axis_{0, 0, 1};
  double span_s_ = 0;
  bool known_ = false, silent_ = false;
  std::atomic<std::uint64_t> gaps_{0};
};

}  // namespace trephine::track
