// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <linux/input.h>

#include <array>
#include <cstdint>
#include <map>

#include "device/rate_hand.h"

namespace trephine::device {

/// One bit a key or button, as the kernel gives them.
using PadKeys = std::array<std::uint8_t, KEY_MAX / 8 + 1>;
inline bool is_down(const PadKeys& keys, int code) { return keys[std::size_t(code / 8)] >> (code % 8) & 1; }

/// What can be asked of a gamepad: how it is held at this moment, whatever its events said.
class PadSource {
 public:
  virtual ~PadSource() = default;
  /// The range and the value of an axis; false where the gamepad has none of that code.
  virtual bool axis(int code, input_absinfo& out) const = 0;
  virtual bool keys(PadKeys& down) const = 0;
};

/// How a gamepad is held, by its events. Axes and buttons are those of the kernel's gamepad protocol
/// (Documentation/input/gamepad.rst).
///
/// Where a reader was too slow, the kernel drops events and says so (SYN_DROPPED, Documentation/input/event-codes.rst):
/// what follows up to the next report is a part of something, and is passed over; then the source is asked. A button
/// that was released meanwhile is thus released.
class PadState {
 public:
  /// Asks the source, which must outlive it.
  explicit PadState(const PadSource& source);
  void take(const input_event& event);
  /// Left stick: in the picture's plane. Right trigger: along the tool; left: back. Right stick: tilts the tool.
  Push push() const;

 private:
  void look();
  double stick(int axis) const;
  bool down(int key) const { return is_down(down_, key); }

  const PadSource& source_;
  std::map<int, input_absinfo> axis_;
  PadKeys down_{};
  bool dropped_ = false;  ///< until the next report
};

}  // namespace trephine::device
