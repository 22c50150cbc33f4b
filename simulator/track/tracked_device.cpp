// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/tracked_device.h"

#include <algorithm>

#include "haptics/haptic_state.h"

namespace trephine::track {
namespace {

constexpr double longest_span_s = 0.1;  // over which a tool is moved to its newest pose

std::vector<std::string> bodies_of(const Tracking& tracking) {
  std::vector<std::string> all;
  for (const TrackedTool& t : tracking.tools) all.push_back(t.body);
  return all;
}

std::vector<int> by_lesson(const Tracking& tracking, const std::vector<std::string>& lesson_tools) {
  std::vector<int> all;
  for (const std::string& name : lesson_tools) all.push_back(tool_for(tracking, name));
  if (all.empty()) all.push_back(tool_for(tracking, ""));
  return all;
}

}  // namespace

TrackedDevice::TrackedDevice(Tracking tracking, const std::vector<std::string>& lesson_tools, double lost_s,
                             double late_s, Clock clock)
    : tracking_(std::move(tracking)),
      reference_to_case_(map_of(tracking_.reference_to_case)),
      body_of_(by_lesson(tracking_, lesson_tools)),
      lost_s_(lost_s),
      clock_(std::move(clock)),
      wanted_(body_of_.front()),
      watch_({bodies_of(tracking_), tracking_.reference, late_s},
             [this](int tool, const RigidMap& map, double now_s) { found(tool, map, now_s); }) {}

void TrackedDevice::take(const IgtlHeader& header, const IgtlContent& content) {
  const std::scoped_lock lock(watching_);
  watch_.take(header, content, clock_());
  unwell_s_.store(watch_.unwell_s(), std::memory_order_relaxed);
}

void TrackedDevice::begin_anew() {
  const std::scoped_lock lock(watching_);
  watch_.begin_anew();
}

WatchCounts TrackedDevice::watched() const {
  const std::scoped_lock lock(watching_);
  return watch_.counts();
}

std::vector<std::string> TrackedDevice::strangers() const {
  const std::scoped_lock lock(watching_);
  return watch_.strangers();
}

std::vector<std::pair<std::string, std::uint64_t>> TrackedDevice::counts() const {
  auto all = listed(watched());
  all.emplace_back("gaps", gaps_.load(std::memory_order_relaxed));
  return all;
}

void TrackedDevice::found(int tool, const RigidMap& tool_to_reference, double now_s) {
  seen_ = true;
  if (tool != wanted_.load(std::memory_order_relaxed)) return;
  const TrackedTool& is = tracking_.tools[std::size_t(tool)];
  Pose pose;
  pose.tool = tool;
  const Vec3 foremost = is.tip_mm - is.axis * (0.5 * is.tip_ball_mm);  // what the simulator means by a tip
  pose.tip_mm = reference_to_case_(tool_to_reference(foremost));
  pose.axis = normalized(reference_to_case_.turn * (tool_to_reference.turn * is.axis));
  pose.at_s = now_s;
  poses_.write(pose);
}

bool TrackedDevice::read(double, device::DeviceReading& out) {
  const double now_s = clock_();
  const Pose before = newest_;
  if (poses_.read(newest_) && newest_.tool == wanted_.load(std::memory_order_relaxed)) {
    // After a gap it is there at once.
    const bool goes_on = known_ && !silent_ && newest_.tool == before.tool;
    from_.tip_mm = shown_mm_, from_.axis = axis_;
    span_s_ = goes_on ? std::clamp(newest_.at_s - before.at_s, 0.0, longest_span_s) : 0;
    known_ = true;
  }
  const bool lost = !known_ || newest_.tool != wanted_.load(std::memory_order_relaxed) ||
                    now_s - newest_.at_s > lost_s_ || unwell_s_.load(std::memory_order_relaxed) >= newest_.at_s;
  if (lost && !silent_) gaps_.fetch_add(1, std::memory_order_relaxed);
  silent_ = lost;
  if (!lost) {
    const double share = span_s_ > 0 ? std::clamp((now_s - newest_.at_s) / span_s_, 0.0, 1.0) : 1;
    shown_mm_ = share < 1 ? from_.tip_mm + (newest_.tip_mm - from_.tip_mm) * share : newest_.tip_mm;
    const Vec3 axis = normalized(from_.axis + (newest_.axis - from_.axis) * share);
    axis_ = share < 1 && axis != Vec3{} ? axis : newest_.axis;
  }
  out = {};
  out.tip_mm = shown_mm_;
  out.axis = axis_;
  out.silent = lost;
  // Where it is nobody knows before its first pose: it is nowhere, and no session begins there.
  if (!known_ || newest_.tool != wanted_.load(std::memory_order_relaxed)) out.buttons |= haptics::haptic_button::lifted;
  return true;
}

void TrackedDevice::tell(const device::DeviceNews& news) {
  const auto in_hand = std::size_t(std::max(0, news.tool));
  wanted_.store(body_of_[std::min(in_hand, body_of_.size() - 1)], std::memory_order_relaxed);
}

}  // namespace trephine::track
