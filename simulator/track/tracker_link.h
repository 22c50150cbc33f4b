// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <atomic>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "base/params.h"
#include "track/igtl/igtl_messages.h"

namespace trephine::track {

struct TrackerParams {
  std::string tracker_host = "127.0.0.1";
  int tracker_port = 18944;
  bool tracker_ask = false;
  double tracker_lost_ms = 200, tracker_late_ms = 200, tracker_wait_s = 60;
  template <class V>
  static void describe(V& v) {
    using P = TrackerParams;
    v.text(&P::tracker_host, "tracker_host",
           "Computer on which the tracker's server runs (PLUS, 3D Slicer): a name or an address. Nothing is sent there "
           "but, with tracker_ask, a request for poses.");
    v.integer(&P::tracker_port, "tracker_port", Range{1, 65535}, "Its TCP port.");
    v.flag(&P::tracker_ask, "tracker_ask", "Ask the server for TDATA messages; without it, it must send by itself.");
    v.number(&P::tracker_lost_ms, "tracker_lost_ms", Range{10, 10000},
             "Time without a pose after which the tool is lost: it rests, and its pedal is up.");
    v.number(&P::tracker_late_ms, "tracker_late_ms", Range{1, 10000},
             "A pose that comes so much later than the quickest one, by its stamp, is not taken.");
    v.number(&P::tracker_wait_s, "tracker_wait_s", Range{0.1, 86400}, "How long to wait for poses.");
  }
};

/// Splits a stream of bytes into messages, whatever pieces it comes in. What is no message of ours is passed over
/// without being kept.
class MessageStream {
 public:
  /// Takes bytes, and calls `take` for each message that they complete. False: what comes is no OpenIGTLink, of
  /// versions 1 or 2.
  bool feed(const std::uint8_t* bytes, std::size_t count,
            const std::function<void(const IgtlHeader&, const IgtlContent&)>& take);
  int version() const { return version_; }  ///< of the last header

 private:
  std::vector<std::uint8_t> kept_;
  std::uint64_t skip_ = 0;
  int version_ = 0;
};

/// Holds a connection to an OpenIGTLink server by a thread of its own, and makes it again when it ends. The functions
/// are called by that thread.
class TrackerLink {
 public:
  using Take = std::function<void(const IgtlHeader&, const IgtlContent&)>;
  /// `begun`: a connection was made. Throws as igtl() does.
  TrackerLink(const TrackerParams& params, Take take, std::function<void()> begun);
  ~TrackerLink();
  TrackerLink(const TrackerLink&) = delete;
  TrackerLink& operator=(const TrackerLink&) = delete;
  std::uint64_t connections() const { return connections_; }
  /// Of what is no OpenIGTLink that we know: the version that it says; 0: there was none.
  int foreign_version() const { return foreign_version_; }
  /// Such as "127.0.0.1:18944".
  std::string endpoint() const;

 private:
  void serve();
  int connected_socket() const;
  void receive(int socket);

  const TrackerParams params_;
  const Take take_;
  const std::function<void()> begun_;
  std::atomic<bool> stop_{false};
  std::atomic<std::uint64_t> connections_{0};
  std::atomic<int> foreign_version_{0};
  std::thread thread_;
};

/// Seconds of a clock that only ascends.
double steady_s();

}  // namespace trephine::track
