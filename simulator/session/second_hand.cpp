// SPDX-License-Identifier: GPL-3.0-or-later
#include "session/second_hand.h"

#include <algorithm>
#include <utility>

#include "base/error.h"
#include "haptics/delayed_walls.h"

namespace trephine::session {
namespace {

// Of a second device its switches count; tool and commands are the first hand's.
constexpr std::uint32_t switches = 0xff;

}  // namespace

haptics::BeltToolParams second_tool(const haptics::ToolParams& tool) {
  const haptics::ToolKind& kind = haptics::tool_kind(tool.tool);
  if (kind.cuts() || kind.marks || kind.from_file)
    throw Error(ExitCode::usage, "", "--second-tool",
                tool.tool + ": the second hand neither cuts nor draws; hold it with --tool");
  haptics::BeltToolParams t;
  static_cast<haptics::ToolParams&>(t) = haptics::own_tool(tool);
  t.name = tool.tool;
  t.blunt = kind.takes_up || kind.rinses;
  return t;
}

void require_two_devices(const device::DeviceChoice& first, const device::DeviceChoice& second) {
  if (first.name != second.name) return;  // also a window's mouse, which is no kind of device
  const std::string held = device::seat_of(first);
  if (held.empty() || held != device::seat_of(second)) return;
  throw Error(ExitCode::usage, "", "--device, --second-device", "both are " + held + ", which one hand alone can hold");
}

void drain(haptics::FrameQueue& queue, bool two_hands, std::vector<haptics::ServoFrame>& frames,
           std::vector<haptics::ServoFrame>& second) {
  if (!two_hands) return queue.drain(frames);
  std::vector<haptics::ServoFrame> both;
  queue.drain(both);
  for (std::size_t n = 0; n + 1 < both.size(); n += 2) {
    frames.push_back(both[n]);
    second.push_back(both[n + 1]);
  }
}

SecondHand::SecondHand(const touch::FeltSpace& space, const haptics::Feels& feels, const haptics::RecordingHeader& h,
                       const haptics::Drilling* drilling, device::Device* device)
    : period_s_(1 / h.rate_hz), device_(device), drilling_(drilling), port_(h.second->port, h.second->force) {
  if (h.second->switch_only) return;
  belt_ = std::make_unique<haptics::ToolBelt>(space, haptics::feels_behind(feels, {}, h.second->port, h.rate_hz),
                                              h.second->force, haptics::ShaftParams(),
                                              std::vector<haptics::BeltToolParams>{h.second->tool}, nullptr);
  belt_->watch(drilling);
}

// What the first hand did, not what it asked for: it may refuse a command.
void SecondHand::obey(const haptics::ToolBelt* first) {
  const int so_far = drilling_ ? drilling_->outcome().undone + drilling_->outcome().resets : 0;
  if (belt_) belt_->obey(first && first->paused(), so_far != taken_back_);
  taken_back_ = so_far;
}

const haptics::HapticState& SecondHand::answer(haptics::HapticInput& in, std::uint32_t lost) {
  if (belt_) {
    if (lost) belt_->latch(lost);
    const haptics::HapticState& s = port_.after(in, belt_->update(in));
    belt_->after(in, s);
    return s;
  }
  state_.faults |= lost;
  state_.proxy_mm = in.tip_mm;
  state_.axis = in.axis;
  return port_.after(in, state_);
}

const haptics::ServoFrame& SecondHand::tick(const haptics::ServoFrame& first, const haptics::ToolBelt* belt) {
  device::DeviceReading reading;
  const bool there = device_->read(std::exchange(first_, false) ? 0 : first.dt_s, reading);
  haptics::HapticInput in;
  in.tip_mm = reading.tip_mm;
  in.axis = reading.axis;
  if (device_->knows_across()) in.across = reading.across;
  in.buttons = reading.buttons & (switches | haptics::haptic_button::lifted);
  in.dt_s = first.dt_s;
  in.period_s = period_s_;
  port_.before(in, there && reading.silent);
  std::uint32_t lost = there ? 0 : haptics::haptic_fault::device_lost;
  if (!belt_ && !(is_finite(in.tip_mm) && is_finite(in.axis))) {  // a tool's own proxy finds that by itself
    in.tip_mm = in.axis = in.across = {};
    lost |= haptics::haptic_fault::pose;
  }
  obey(belt);
  const haptics::HapticState& s = answer(in, lost);
  device_->tell({first.time_s, s.proxy_mm, s.touched, s.inside, s.faults, s.torque_n_mm, s.axis, s.across, s.events,
                 s.locked, 0});
  device_->send(s.force_n);
  frame_.tick = first.tick;
  frame_.time_s = first.time_s;
  frame_.dt_s = first.dt_s;
  haptics::put_input(in, frame_);
  haptics::put_answer(s, frame_);
  most_force_n_ = std::max(most_force_n_, norm(s.force_n));
  touching_ += s.touched != 0;
  faults_.store(faults_.load(std::memory_order_relaxed) | s.faults, std::memory_order_relaxed);
  return frame_;
}

haptics::ServoFrame SecondHand::again(const haptics::ServoFrame& recorded, const haptics::ToolBelt* belt) {
  haptics::HapticInput in = haptics::input_of(recorded, 1 / period_s_);
  in.period_s = period_s_;
  port_.again(in, recorded.faults);
  haptics::ServoFrame out = recorded;
  obey(belt);
  const std::uint32_t given = haptics::haptic_fault::device_lost | (belt_ ? 0 : haptics::haptic_fault::pose);
  haptics::put_answer(answer(in, recorded.faults & given), out);
  return out;
}

void SecondHand::follow(const haptics::ServoFrame& recorded, const haptics::ToolBelt* belt) {
  obey(belt);
  if (belt_) belt_->follow(haptics::input_of(recorded, 1 / period_s_), haptics::state_of(recorded));
}

}  // namespace trephine::session
