// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The other end of a UDP device, for tests; examples/udp_client is the one to copy.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstring>

#include "device/udp_packet.h"

namespace trephine {

class UdpClient {
 public:
  explicit UdpClient(int port, std::uint32_t session = 1) : socket_(socket(AF_INET, SOCK_DGRAM, 0)) {
    next.session = session;
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(std::uint16_t(port));
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    connect(socket_, reinterpret_cast<sockaddr*>(&to), sizeof to);
  }
  ~UdpClient() { close(socket_); }
  UdpClient(const UdpClient&) = delete;
  UdpClient& operator=(const UdpClient&) = delete;

  device::UdpPose next;  ///< sequence: the last sent
  void send_pose(Vec3 tip_mm) {
    next.reading.tip_mm = tip_mm;
    ++next.sequence;
    again();
  }
  void again() {
    const device::UdpBytes bytes = device::encode_pose(next);
    send_bytes(bytes.data(), bytes.size());
  }
  void send_bytes(const void* bytes, std::size_t count) { (void)!::send(socket_, bytes, count, 0); }

  /// The next answer; false where none comes in that time.
  bool receive(device::UdpForce& out, int patience_ms = 60000) {
    pollfd p{socket_, POLLIN, 0};
    if (poll(&p, 1, patience_ms) <= 0) return false;
    std::uint8_t bytes[256] = {};
    const ssize_t count = recv(socket_, bytes, sizeof bytes, 0);
    return count > 0 && device::decode_force(bytes, std::size_t(count), out);
  }
  /// Sends and waits for the answer to that very pose.
  bool ask(Vec3 tip_mm, device::UdpForce& out, int patience_ms = 60000) {
    send_pose(tip_mm);
    while (receive(out, patience_ms))
      if (out.answers == next.sequence) return true;
    return false;
  }

 private:
  int socket_;
};

}  // namespace trephine
