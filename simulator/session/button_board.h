// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <atomic>
#include <cstdint>
#include <memory>

#include "device/device.h"

namespace trephine::session {

/// Buttons that are pressed elsewhere than on the device, such as on a keyboard: pedal, tool and command of a session
/// with several tools, as haptics/tool_belt.h says. One thread writes them, and the servo's thread reads them.
struct ButtonBoard {
  std::atomic<std::uint32_t> buttons{0};
};

/// The device with the board's buttons: the pedal is down where either has it, a command is the device's or else the
/// board's, and the tool is that of the two which changed last, so that a device with buttons of its own may change it
/// too. The device itself where the board is null.
std::unique_ptr<device::Device> with_board(std::unique_ptr<device::Device> device,
                                           std::shared_ptr<const ButtonBoard> board);

}  // namespace trephine::session
