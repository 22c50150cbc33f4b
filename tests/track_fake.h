// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A tracker that never was: what it would send of bodies that move as they are told, by the classes of libopenigtlink.
#include <openigtlink/igtlStatusMessage.h>
#include <openigtlink/igtlStringMessage.h>
#include <openigtlink/igtlTrackingDataMessage.h>
#include <openigtlink/igtlTransformMessage.h>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "base/pi.h"
#include "base/rigid_fit.h"
#include "lesson/print_record.h"
#include "random.h"
#include "track/body_watch.h"
#include "track/tracker_link.h"

namespace track_fake {

using namespace trephine;
using Bytes = std::vector<std::uint8_t>;

inline Mat3 turn_about(Vec3 axis, double radians) {  // Rodrigues
  const Vec3 a = normalized(axis);
  const double c = std::cos(radians), s = std::sin(radians);
  Mat3 m;
  for (int k = 0; k < 3; ++k) {
    Vec3 e;
    e[k] = 1;
    m.column[std::size_t(k)] = e * c + cross(a, e) * s + a * (dot(a, e) * (1 - c));
  }
  return m;
}
inline Mat3 product(const Mat3& a, const Mat3& b) {
  Mat3 m;
  for (std::size_t k = 0; k < 3; ++k) m.column[k] = a * b.column[k];
  return m;
}
inline Mat3 between(Vec3 from, Vec3 to) {  // the shortest turn
  const Vec3 axis = cross(from, to);
  return norm(axis) < 1e-12 ? Mat3{} : turn_about(axis, std::atan2(norm(axis), dot(from, to)));
}

/// One number of the normal distribution.
inline double normal(Random& random) { return std::sqrt(-2 * std::log(1 - random())) * std::cos(2 * pi * random()); }
/// A body as a tracker sees it: its origin is off by `mm` along each axis, and it is turned by as much over 100 mm.
inline RigidMap seen(const RigidMap& is, double mm, Random& random) {
  if (mm == 0) return is;
  const auto noise = [&] { return Vec3{normal(random), normal(random), normal(random)} * mm; };
  const Vec3 turn = noise() / 100;
  return {product(turn_about(turn, norm(turn)), is.turn), is.offset_mm + noise()};
}

inline Bytes bytes_of(igtl::MessageBase& message, double stamp_s) {
  message.SetTimeStamp(unsigned(stamp_s), unsigned((stamp_s - std::floor(stamp_s)) * 4294967296.0));
  message.Pack();
  const auto* begin = static_cast<const std::uint8_t*>(message.GetPackPointer());
  return {begin, begin + message.GetPackSize()};
}
inline void put(const RigidMap& map, igtl::Matrix4x4& m) {
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) m[r][c] = float(map.turn.column[std::size_t(c)][r]);
    m[r][3] = float(map.offset_mm[r]);
  }
  m[3][0] = m[3][1] = m[3][2] = 0, m[3][3] = 1;
}
inline Bytes transform(const std::string& name, const RigidMap& map, double stamp_s) {
  igtl::TransformMessage::Pointer message = igtl::TransformMessage::New();
  igtl::Matrix4x4 m;
  put(map, m);
  message->SetDeviceName(name.c_str());
  message->SetMatrix(m);
  return bytes_of(*message, stamp_s);
}
struct Element {
  std::string name;
  RigidMap map;
  int type = igtl::TrackingDataElement::TYPE_6D;
};
inline Bytes tdata(const std::vector<Element>& elements, double stamp_s) {
  igtl::TrackingDataMessage::Pointer message = igtl::TrackingDataMessage::New();
  message->SetDeviceName("Tracker");
  for (const Element& e : elements) {
    igtl::TrackingDataElement::Pointer element = igtl::TrackingDataElement::New();
    igtl::Matrix4x4 m;
    put(e.map, m);
    element->SetName(e.name.c_str());
    element->SetType(igtlUint8(e.type));
    element->SetMatrix(m);
    message->AddTrackingDataElement(element);
  }
  return bytes_of(*message, stamp_s);
}
inline Bytes status(int code, double stamp_s) {
  igtl::StatusMessage::Pointer message = igtl::StatusMessage::New();
  message->SetDeviceName("Tracker");
  message->SetCode(code);
  message->SetStatusString("as it is");
  return bytes_of(*message, stamp_s);
}
/// Feeds a message into what takes them; false where the stream is refused.
inline bool feed(track::MessageStream& stream, const Bytes& bytes, const track::TrackerLink::Take& take) {
  return stream.feed(bytes.data(), bytes.size(), take);
}

/// A tool with its body, a print and its reference, somewhere before a tracker.
struct Theatre {
  Vec3 tip_mm{3, -2, -151}, axis = normalized(Vec3{-0.02, 0.03, 1});  ///< of the tool, in its body's frame
  RigidMap case_to_reference{turn_about({0.3, -0.5, 1}, 1.1), {40, -65, 130}};
  RigidMap reference_to_tracker{turn_about({1, 0.2, -0.4}, 2.0), {120, -340, -1450}};
  /// The tool's body before the tracker, where its tip and axis are so in the case, turned about the axis.
  RigidMap body_at(Vec3 tip_case_mm, Vec3 axis_case, double spin = 0) const {
    RigidMap body;
    body.turn = product(turn_about(axis_case, spin), between(axis, normalized(axis_case)));
    body.offset_mm = tip_case_mm - body.turn * tip_mm;
    return then(then(body, case_to_reference), reference_to_tracker);
  }
};

/// Eight marks about a head, as a print has them; no turn or mirror image looks alike.
inline lesson::PrintRecord a_print() {
  lesson::PrintRecord print;
  print.case_token = "head";
  print.case_sha256 = std::string(64, 'a');
  print.program = "test";
  const Vec3 ways[] = {{0.1, -0.9, 0.4},  {0.8, -0.5, 0.3}, {-0.75, -0.45, 0.5}, {0.95, 0.2, 0.15},
                       {-0.9, 0.3, 0.25}, {0.5, 0.8, 0.35}, {-0.35, 0.9, 0.1},   {0.15, 0.2, 1}};
  for (const Vec3& way : ways) {
    lesson::PrintMark mark;
    mark.number = std::int64_t(print.marks.size()) + 1;
    mark.case_mm = normalized(way) * (95 + 3 * double(print.marks.size())) + Vec3{0, -10, 20};
    mark.post = -normalized(way);
    mark.diameter_mm = 10;
    print.marks.push_back(mark);
  }
  print.targets = {{"monro_right", {-4, -8, 25}}, {"monro_left", {4, -8, 25}}};
  return print;
}

/// Where a tip is slid over a mark: on the side away from its post, `n` of `count`.
inline Vec3 on_mark(const lesson::PrintMark& mark, int n, int count, double ball_mm = 0) {
  const double down = 1.9 * (n + 0.5) / count, turn = pi * (3 - std::sqrt(5.0)) * n;  // to some 110 degrees
  const Vec3 out = -mark.post, aside = normalized(cross(out, std::abs(out.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}));
  const Vec3 other = cross(out, aside);
  const Vec3 way = out * std::cos(down) + (aside * std::cos(turn) + other * std::sin(turn)) * std::sin(down);
  return mark.case_mm + way * 0.5 * (mark.diameter_mm + ball_mm);
}

/// Sends frames to whoever connects, one client at a time. (The library's own server socket cannot be made twice on one
/// port.)
class Server {
 public:
  using Frame = std::function<std::vector<Bytes>(double now_s)>;
  explicit Server(int port = 0) : port_(port) {
    const int s = listening();
    sockaddr_in is{};
    socklen_t size = sizeof is;
    getsockname(s, reinterpret_cast<sockaddr*>(&is), &size);
    port_ = ntohs(is.sin_port);
    close(s);
  }
  ~Server() { stop(); }
  int port() const { return port_; }
  std::uint64_t frames() const { return frames_; }
  void start(Frame frame, int pause_ms = 5) {
    stop_ = false;
    thread_ = std::thread([this, frame = std::move(frame), pause_ms] {
      const int at = listening();
      while (!stop_) {
        pollfd p{at, POLLIN, 0};
        const int client = poll(&p, 1, 50) > 0 ? accept(at, nullptr, nullptr) : -1;
        for (bool there = client >= 0; !stop_ && there;
             std::this_thread::sleep_for(std::chrono::milliseconds(pause_ms))) {
          for (const Bytes& b : frame(track::steady_s()))
            there = there && send(client, b.data(), b.size(), MSG_NOSIGNAL) == ssize_t(b.size());
          ++frames_;
        }
        if (client >= 0) close(client);
      }
      close(at);
    });
  }
  void stop() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
  }

 private:
  int listening() const {
    const int s = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0), one = 1;
    setsockopt(s, SOL_SOCKET, SO_REUSEADDR, &one, sizeof one);
    sockaddr_in at{};
    at.sin_family = AF_INET;
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    at.sin_port = htons(std::uint16_t(port_));
    if (bind(s, reinterpret_cast<sockaddr*>(&at), sizeof at) != 0 || listen(s, 4) != 0)
      throw std::runtime_error("no port is free");
    return s;
  }
  int port_ = 0;
  std::atomic<bool> stop_{false};
  std::atomic<std::uint64_t> frames_{0};
  std::thread thread_;
};

}  // namespace track_fake
