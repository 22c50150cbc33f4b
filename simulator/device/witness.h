// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <memory>
#include <string>

#include "device/device.h"

namespace trephine::device {

/// The device, whose poses and buttons also go to the record server at that port of the loopback interface, as those of
/// a device by UDP do (device/udp_packet.h), from a thread of its own: a tick makes no system call. What the server
/// answers is not felt. `session` says which lesson it is; a server of another one does not take it. Where a pose is
/// not answered for 10 s the device is lost, so that nobody goes on with a lesson that is not recorded there. Each
/// command is sent until a tick of the server took it.
///
/// Throws Error 74 where nobody answers a first pose, of a tool that nobody holds, for 30 s, or where the server is for
/// another lesson or held by another window. `flag` named the port.
std::unique_ptr<Device> with_witness(std::unique_ptr<Device> device, int port, std::uint32_t session,
                                     const std::string& flag = "--record-server-port");

}  // namespace trephine::device
