// SPDX-License-Identifier: GPL-3.0-or-later
#include "device/pad_state.h"

#include <algorithm>
#include <iterator>

namespace trephine::device {
namespace {

constexpr int axes[] = {ABS_X, ABS_Y, ABS_Z, ABS_RX, ABS_RY, ABS_RZ, ABS_GAS, ABS_BRAKE};
// Button 1 of the device, and so on.
constexpr int buttons[] = {BTN_SOUTH, BTN_EAST, BTN_WEST, BTN_NORTH, BTN_TL, BTN_TR, BTN_SELECT, BTN_START};

double share(const input_absinfo& i) {
  return std::clamp((double(i.value) - i.minimum) / (double(i.maximum) - i.minimum), 0.0, 1.0);
}

}  // namespace

PadState::PadState(const PadSource& source) : source_(source) {
  for (const int axis : axes) {
    input_absinfo info{};
    if (source.axis(axis, info) && info.maximum > info.minimum) axis_[axis] = info;
  }
  look();
}

void PadState::look() {
  for (auto& [axis, info] : axis_) {
    input_absinfo now{};
    if (source_.axis(axis, now)) info.value = now.value;
  }
  PadKeys now{};
  down_ = source_.keys(now) ? now : PadKeys{};  // nobody knows: nothing is pressed
}

void PadState::take(const input_event& e) {
  if (e.type == EV_SYN && e.code == SYN_DROPPED) {
    dropped_ = true;
  } else if (dropped_) {
    if (e.type != EV_SYN || e.code != SYN_REPORT) return;
    dropped_ = false;
    look();
  } else if (e.type == EV_ABS) {
    if (const auto found = axis_.find(e.code); found != axis_.end()) found->second.value = e.value;
  } else if (e.type == EV_KEY && e.code < KEY_MAX) {
    std::uint8_t& byte = down_[std::size_t(e.code / 8)];
    const auto bit = std::uint8_t(1u << (e.code % 8));
    byte = std::uint8_t(e.value != 0 ? byte | bit : byte & ~bit);
  }
}

double PadState::stick(int axis) const {
  const auto found = axis_.find(axis);
  return found == axis_.end() ? 0 : 2 * share(found->second) - 1;
}

Push PadState::push() const {
  // Gamepads without a driver of their own have the right stick where others have the triggers.
  const bool usual = axis_.count(ABS_RX) != 0;
  const auto trigger = [&](int analog, int digital) {
    const auto found = axis_.find(analog);
    const double pressed = found == axis_.end() ? 0 : share(found->second);
    return std::max(pressed, down(digital) ? 1.0 : 0.0);
  };
  Push p;
  p.move = {stick(ABS_X), -stick(ABS_Y), 0};
  p.turn = {stick(usual ? ABS_RY : ABS_RZ), stick(usual ? ABS_RX : ABS_Z), 0};
  p.ahead = trigger(usual ? ABS_RZ : ABS_GAS, BTN_TR2) - trigger(usual ? ABS_Z : ABS_BRAKE, BTN_TL2);
  for (std::size_t n = 0; n < std::size(buttons); ++n)
    if (down(buttons[n])) p.buttons |= std::uint32_t{1} << n;
  return p;
}

}  // namespace trephine::device
