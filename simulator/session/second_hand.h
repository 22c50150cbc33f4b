// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "device/device_type.h"
#include "device/workspace.h"
#include "haptics/recording.h"
#include "haptics/servo.h"
#include "touch/felt_space.h"

namespace trephine::session {

/// What a session asks of the other hand.
struct SecondOptions {
  device::DeviceChoice device;
  device::WorkspaceParams workspace;
  haptics::ForceParams force;
  haptics::PortParams port;
  haptics::BeltToolParams tool;
  bool switch_only = false;  ///< it holds nothing
  /// Makes the device instead, where it is given: of a record server.
  std::function<std::unique_ptr<device::Device>(const device::DeviceScene&)> own_device;
  int record_server_port = 0;  ///< where its poses and switches go to the record server, if the first hand's do
};

/// A tool that the other hand holds without a lesson: what takes up or rinses enters nothing. Throws Error 64 for one
/// that cuts, draws, or has points of its own.
haptics::BeltToolParams second_tool(const haptics::ToolParams& tool);
/// Throws Error 64 where both hands would hold the same device.
void require_two_devices(const device::DeviceChoice& first, const device::DeviceChoice& second);

/// Appends what waits in the queue: of two hands, each hand's frames.
void drain(haptics::FrameQueue& queue, bool two_hands, std::vector<haptics::ServoFrame>& frames,
           std::vector<haptics::ServoFrame>& second);

/// The other hand in a case: a tool of its own in the same volume, felt with its device's own limits. It cuts nothing.
/// Where the first hand's cuts are taken back, and in a pause that the first hand's belt took, it feels nothing until
/// it was in the open, as the first does (haptics::ToolBelt); a command that the first refuses does nothing here
/// either. A hand that is a switch alone has neither tool nor force.
class SecondHand : public haptics::OtherHand {
 public:
  /// `feels`: of the case; `header`: of the recording, with the second hand; `drilling` is the first hand's, and may be
  /// null. What they refer to must outlive it. Throws as ToolBelt does. `device`: null where a recording is run again.
  SecondHand(const touch::FeltSpace& space, const haptics::Feels& feels, const haptics::RecordingHeader& header,
             const haptics::Drilling* drilling, device::Device* device = nullptr);

  const haptics::ServoFrame& tick(const haptics::ServoFrame& first, const haptics::ToolBelt* belt) override;
  std::uint32_t faults() const override { return faults_.load(std::memory_order_relaxed); }
  /// The same for a tick that was recorded: its answer to the recorded pose. `belt`: the first hand's after that tick.
  haptics::ServoFrame again(const haptics::ServoFrame& recorded, const haptics::ToolBelt* belt);
  /// again() with the answer that was recorded.
  void follow(const haptics::ServoFrame& recorded, const haptics::ToolBelt* belt);
  const haptics::ToolBelt* belt() const { return belt_.get(); }  ///< its own; null of a switch alone

  std::uint64_t jumps() const { return port_.jumps(); }
  std::uint64_t gaps() const { return port_.gaps(); }
  double most_force_n() const { return most_force_n_; }  ///< after the loop
  std::uint64_t touching() const { return touching_; }   ///< ticks; after the loop

 private:
  void obey(const haptics::ToolBelt* first);
  const haptics::HapticState& answer(haptics::HapticInput& in, std::uint32_t lost);

  double period_s_;
  device::Device* device_;
  const haptics::Drilling* drilling_;
  int taken_back_ = 0;  // strokes and more, so far
  haptics::DevicePort port_;
  std::unique_ptr<haptics::ToolBelt> belt_;  // null of a switch alone
  haptics::HapticState state_;               // then
  haptics::ServoFrame frame_;
  double most_force_n_ = 0;
  std::uint64_t touching_ = 0;
  bool first_ = true;
  std::atomic<std::uint32_t> faults_{0};
};

}  // namespace trephine::session
