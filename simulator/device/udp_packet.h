// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "device/device.h"

namespace trephine {

/// The two packets of the UDP device, version 1, little endian, without gaps (docs/haptics.md): a pose to the servo,
/// and the force that answers it.
constexpr int udp_version = 1;

struct UdpPose {
  std::uint32_t session = 0;   ///< any number that distinguishes a client's runs
  std::uint64_t sequence = 0;  ///< from 1, ascending
  double time_s = 0;           ///< the client's clock; it comes back in the answer
  DeviceReading reading;
};
struct UdpForce {
  bool busy = false;  ///< another client holds the tool
  std::uint32_t session = 0;
  std::uint64_t answers = 0;  ///< the sequence of the pose
  double pose_time_s = 0;
  DeviceNews news;
  Vec3 force_n;
};

constexpr std::size_t udp_pose_bytes = 80, udp_force_bytes = 96;
std::array<std::uint8_t, udp_pose_bytes> encode_pose(const UdpPose& pose);
std::array<std::uint8_t, udp_force_bytes> encode_force(const UdpForce& force);

/// Returns false where it is not such a packet: length, magic, version, sequence 0, a time that is not finite, an axis
/// that is not a unit vector (within 1 %). A position or axis that is not finite is a fault of the device, not of the
/// packet, and is passed on.
bool decode_pose(const std::uint8_t* bytes, std::size_t count, UdpPose& out);
bool decode_force(const std::uint8_t* bytes, std::size_t count, UdpForce& out);

}  // namespace trephine
