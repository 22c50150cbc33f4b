// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <atomic>
#include <memory>
#include <string>
#include <thread>

#include "base/params.h"
#include "base/progress.h"
#include "device/mailbox.h"
#include "device/udp_packet.h"

namespace trephine::device {

struct UdpParams {
  std::string address = "127.0.0.1";
  int port = 20517;
  double timeout_ms = 50, resume_s = 10, wait_s = 60;
  template <class V>
  static void describe(V& v) {
    using P = UdpParams;
    v.text(&P::address, "address",
           "Address on which it listens, IPv4 or IPv6 in numbers. On any other than the loopback, everybody who can "
           "reach it can hold the tool.");
    v.integer(&P::port, "port", Range{0, 65535}, "UDP port; 0: any free port, which is then reported.");
    v.number(&P::timeout_ms, "timeout_ms", Range{2, 10000}, "Time without a pose after which the force is zero.");
    v.number(&P::resume_s, "resume_s", Range{0, 3600},
             "How much longer the same client may be silent and then go on; after that the device is lost.");
    v.number(&P::wait_s, "wait_s", Range{0, 86400}, "How long to wait for the first pose; 0: until stopped.");
  }
};

/// A device at the other end of a socket (docs/reference/udp-device.md; a client: examples/udp_client). A thread of its
/// own receives and sends. A mailbox in each direction lies between it and the servo thread, whose calls therefore make
/// no system call, lock or allocation. Each pose that a tick took is answered once, with that tick's force.
///
/// The first client that sends a pose holds the session. After timeout_ms without a pose the device is silent, until
/// the same client sends another; after resume_s more, or when another client takes over, it is lost and stays lost.
/// Packets of other clients, and packets that are malformed, duplicate or late, change nothing and are counted. A
/// client stays with the version of its first pose; poses of the other one are malformed.
class UdpDevice : public Device {
 public:
  /// Nanoseconds, ascending; asked for by both threads.
  using Clock = std::int64_t (*)();
  static std::int64_t monotonic_ns();
  /// Listens from now on. Throws Error 64 for an address that is not valid, 74 where it cannot be used. `realtime` asks
  /// for SCHED_FIFO below the servo's priority.
  /// `only_session`: poses of another session are strangers' (UdpPose::session); 0: any.
  explicit UdpDevice(const UdpParams& params, bool realtime = false, Clock clock = monotonic_ns,
                     std::uint32_t only_session = 0);
  ~UdpDevice() override;
  UdpDevice(const UdpDevice&) = delete;
  UdpDevice& operator=(const UdpDevice&) = delete;

  /// Such as "127.0.0.1:20517".
  const std::string& endpoint() const { return endpoint_; }
  int port() const { return port_; }
  /// Waits until there is a client. Throws Error 66 after wait_s, Cancelled.
  void wait(const Progress& progress) const;

  double damping_n_s_per_mm() const override { return 0; }  ///< not known, so none is assumed
  bool read(double dt_s, DeviceReading& out) override;
  void tell(const DeviceNews& news) override;
  /// Of the client that holds the tool: whether it speaks version 2.
  bool knows_across() const override { return version_ > 1; }
  void send(Vec3 force_n) override;
  std::vector<std::pair<std::string, std::uint64_t>> counts() const override;

 private:
  struct Incoming {
    UdpPose pose;
    std::int64_t received_ns = 0;
    bool lost = false;  // before this pose: nothing for too long, or another client
  };
  struct Network;
  void serve();

  UdpParams params_;
  std::int64_t timeout_ns_, lost_ns_;
  const Clock clock_;
  const std::uint32_t only_session_;
  std::string endpoint_;
  int port_ = 0;
  std::unique_ptr<Network> network_;  // the thread's
  Mailbox<Incoming> poses_;
  Mailbox<UdpForce> forces_;
  Incoming newest_;  // the servo thread's
  UdpForce answer_;
  bool known_ = false, lost_ = false, silent_ = false;
  std::atomic<bool> stop_{false}, connected_{false};
  std::atomic<int> version_{0};
  std::atomic<std::uint32_t> events_{0};  ///< since the last answer
  std::atomic<std::uint64_t> taken_{0}, malformed_{0}, late_{0}, strangers_{0}, answers_{0}, gaps_{0};
  std::thread thread_;
};

}  // namespace trephine::device
