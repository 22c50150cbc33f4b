// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>

#include "device/device.h"

namespace trephine::device {

/// The device, whose poses and buttons also go to the record server at that port of the loopback interface, as those of
/// a device by UDP do (device/udp_packet.h), from a thread of its own: a tick makes no system call. What the server
/// answers is not felt. Where it is silent for `silent_s` the device is lost, so that nobody goes on with a lesson that
/// is not recorded there.
///
/// Throws Error 74 where nobody answers a first pose, of a tool that nobody holds, within that time.
std::unique_ptr<Device> with_witness(std::unique_ptr<Device> device, int port, double silent_s = 3);

}  // namespace trephine::device
