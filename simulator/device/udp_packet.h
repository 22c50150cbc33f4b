// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "device/device.h"

namespace trephine::device {

/// The two packets of the UDP device, versions 1 and 2, little endian, without gaps (docs/reference/udp-device.md): a
/// pose to the servo, and the force that answers it. A pose is answered in its own version.
constexpr int udp_version = 2;

struct UdpPose {
  int version = udp_version;
  std::uint32_t session = 0;   ///< any number that distinguishes a client's runs
  std::uint64_t sequence = 0;  ///< from 1, ascending
  double time_s = 0;           ///< the client's clock; it comes back in the answer
  DeviceReading reading;       ///< of version 1 without `across`
  // Of version 2. Where a packet is read they are in reading.buttons as well.
  bool lifted = false;        ///< the tool is not held (haptic_button::lifted)
  std::uint32_t pedals = 0;   ///< 1 the drill's, 2 the mark of an incision
  int tool = 0, command = 0;  ///< of a session with several tools (tool_belt.h)
};
struct UdpForce {
  int version = udp_version;
  bool busy = false;  ///< another client holds the tool
  std::uint32_t session = 0;
  std::uint64_t answers = 0;  ///< the sequence of the pose
  double pose_time_s = 0;
  /// Of version 1 without torque, orientation, events, lock and tool. The events are those of all ticks since the last
  /// answer.
  DeviceNews news;
  Vec3 force_n;
};

constexpr std::size_t udp_pose_bytes_1 = 80, udp_force_bytes_1 = 96, udp_pose_bytes = 96, udp_force_bytes = 160;
struct UdpBytes {
  std::array<std::uint8_t, udp_force_bytes> bytes{};
  std::size_t count = 0;
  const std::uint8_t* data() const { return bytes.data(); }
  std::size_t size() const { return count; }
  bool operator==(const UdpBytes& o) const { return count == o.count && bytes == o.bytes; }
};
UdpBytes encode_pose(const UdpPose& pose);
UdpBytes encode_force(const UdpForce& force);

/// Returns false where it is not such a packet: length, magic, version, sequence 0, a time that is not finite, an axis
/// that is not a unit vector or a quaternion that is not one (within 1 %), bits that no version names. A position or
/// orientation that is not finite is a fault of the device, not of the packet, and is passed on.
bool decode_pose(const std::uint8_t* bytes, std::size_t count, UdpPose& out);
bool decode_force(const std::uint8_t* bytes, std::size_t count, UdpForce& out);

}  // namespace trephine::device
