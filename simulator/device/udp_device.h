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

namespace trephine {

struct UdpParams {
  std::string address = "127.0.0.1";
  int port = 20517;
  double timeout_ms = 50, wait_s = 60;
  template <class V>
  static void describe(V& v) {
    using P = UdpParams;
    v.text(&P::address, "address",
           "Where it listens, an address of IPv4 or IPv6 in numbers; another than the loopback lets whoever reaches it "
           "hold the tool.");
    v.integer(&P::port, "port", Range{0, 65535}, "UDP port; 0: any free one, which it says.");
    v.number(&P::timeout_ms, "timeout_ms", Range{2, 10000}, "Without a pose for so long the device is lost.");
    v.number(&P::wait_s, "wait_s", Range{0, 86400}, "How long it waits for the first pose; 0: until it is stopped.");
  }
};

/// A device at the other end of a socket (docs/haptics.md; examples/udp_client is such an end). A thread of its own
/// receives and sends, and a mailbox each way lies between it and the servo thread, whose calls so make no system call,
/// lock or allocate. Each pose that a tick took is answered once, with that tick's force.
///
/// The first client that sends a pose is the session's. Without a pose for timeout_ms, or taken over by another client
/// after that, the device is lost and stays so. Packets of others, and those that are malformed, duplicates, or late,
/// change nothing and are counted.
class UdpDevice : public Device {
 public:
  /// Listens from now on. Throws 64 for an address that is none, 74 where it cannot be had. `realtime`: asks for
  /// SCHED_FIFO below the servo's.
  explicit UdpDevice(const UdpParams& params, bool realtime = false);
  ~UdpDevice() override;
  UdpDevice(const UdpDevice&) = delete;
  UdpDevice& operator=(const UdpDevice&) = delete;

  /// "127.0.0.1:20517"
  const std::string& endpoint() const { return endpoint_; }
  int port() const { return port_; }
  /// Until a client is there. Throws 66 after wait_s, Cancelled.
  void wait(const Progress& progress) const;

  double damping_n_s_per_mm() const override { return 0; }  ///< not known: none is counted on
  bool read(double dt_s, DeviceReading& out) override;
  void tell(const DeviceNews& news) override { answer_.news = news; }
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
  std::int64_t timeout_ns_;
  std::string endpoint_;
  int port_ = 0;
  std::unique_ptr<Network> network_;  // the thread's
  Mailbox<Incoming> poses_;
  Mailbox<UdpForce> forces_;
  Incoming newest_;  // the servo thread's
  UdpForce answer_;
  bool known_ = false, lost_ = false;
  std::atomic<bool> stop_{false}, connected_{false};
  std::atomic<std::uint64_t> taken_{0}, malformed_{0}, late_{0}, strangers_{0}, answers_{0};
  std::thread thread_;
};

}  // namespace trephine
