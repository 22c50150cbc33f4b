// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace trephine::haptics {

/// One tick of the servo loop as it is recorded, little endian, without gaps (docs/reference/recordings.md): 240 bytes
/// where the device knows how the tool is turned about its axis, else without the last 24.
struct ServoFrame {
  std::uint64_t tick = 0;
  double time_s = 0, dt_s = 0;
  double tip_mm[3] = {}, axis[3] = {};
  double proxy_mm[3] = {}, normal[3] = {}, force_n[3] = {};
  std::uint32_t buttons = 0;
  std::int32_t touched = 0, face = 0, inside = 0, held_by = 0;
  std::uint32_t events = 0, faults = 0, late_us = 0;
  std::int32_t held_at = 0;  ///< HapticState::held_at, and the places, zero behind the last
  float held_mm[3][3] = {};
  double across[3] = {};  ///< DeviceReading::across
};
constexpr std::size_t short_frame_bytes = 216;
static_assert(sizeof(ServoFrame) == 240 && offsetof(ServoFrame, across) == short_frame_bytes &&
              std::is_trivially_copyable_v<ServoFrame>);

}  // namespace trephine::haptics
