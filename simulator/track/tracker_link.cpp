// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/tracker_link.h"

#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <memory>

#include "track/igtl_library.h"

namespace trephine::track {
namespace {

constexpr std::uint64_t most_body_bytes = std::uint64_t{1} << 31;  // beyond it is no message
constexpr std::uint64_t most_read_bytes = 1 << 16;                 // of a type that we read
constexpr int poll_ms = 50, connect_ms = 3000;
constexpr double dead_s = 5;  // without a byte a connection is made again
constexpr auto pause = std::chrono::milliseconds(300);

// The type is read whole; the bytes of any other are passed over.
bool is_read(const IgtlHeader& h) {
  return h.body_bytes <= most_read_bytes && (std::strcmp(h.type, "TRANSFORM") == 0 ||
                                             std::strcmp(h.type, "TDATA") == 0 || std::strcmp(h.type, "STATUS") == 0);
}

}  // namespace

double steady_s() {
  timespec t{};
  clock_gettime(CLOCK_MONOTONIC, &t);  // read in user space (vDSO)
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

bool MessageStream::feed(const std::uint8_t* bytes, std::size_t count,
                         const std::function<void(const IgtlHeader&, const IgtlContent&)>& take) {
  while (count > 0) {
    if (skip_ > 0) {
      const auto part = std::size_t(std::min<std::uint64_t>(skip_, count));
      skip_ -= part, bytes += part, count -= part;
      continue;
    }
    IgtlHeader h{};
    std::uint64_t whole = igtl_header_bytes;
    if (kept_.size() >= igtl_header_bytes) {
      igtl().header(kept_.data(), &h);
      whole += h.body_bytes;
    }
    const auto part = std::size_t(std::min<std::uint64_t>(whole - kept_.size(), count));
    kept_.insert(kept_.end(), bytes, bytes + part);
    bytes += part, count -= part;
    if (kept_.size() < whole) continue;
    if (whole == igtl_header_bytes) {
      igtl().header(kept_.data(), &h);
      version_ = h.version;
      if (h.version < 1 || h.version > 2 || h.body_bytes > most_body_bytes) return false;
      if (!is_read(h)) {
        skip_ = h.body_bytes;
        kept_.clear();
        continue;
      }
      if (h.body_bytes > 0) continue;
    }
    IgtlContent content{};
    igtl().content(&h, kept_.data() + igtl_header_bytes, &content);
    kept_.clear();
    take(h, content);
  }
  return true;
}

TrackerLink::TrackerLink(const TrackerParams& params, Take take, std::function<void()> begun)
    : params_(params), take_(std::move(take)), begun_(std::move(begun)) {
  igtl();  // what is missing is known before a thread needs it
  thread_ = std::thread([this] { serve(); });
}

TrackerLink::~TrackerLink() {
  stop_ = true;
  thread_.join();
}

std::string TrackerLink::endpoint() const { return params_.tracker_host + ":" + std::to_string(params_.tracker_port); }

// Below 0 where nobody answers.
int TrackerLink::connected_socket() const {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_NUMERICSERV;
  addrinfo* found = nullptr;
  if (getaddrinfo(params_.tracker_host.c_str(), std::to_string(params_.tracker_port).c_str(), &hints, &found) != 0)
    return -1;
  const std::unique_ptr<addrinfo, void (*)(addrinfo*)> all(found, freeaddrinfo);
  for (const addrinfo* a = found; a && !stop_; a = a->ai_next) {
    const int s = socket(a->ai_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, a->ai_protocol);
    if (s < 0) continue;
    bool there = connect(s, a->ai_addr, a->ai_addrlen) == 0;
    if (!there && errno == EINPROGRESS)
      for (int waited = 0; waited < connect_ms && !stop_ && !there; waited += poll_ms) {
        pollfd p{s, POLLOUT, 0};
        if (poll(&p, 1, poll_ms) <= 0) continue;
        int fault = 0;
        socklen_t size = sizeof fault;
        there = getsockopt(s, SOL_SOCKET, SO_ERROR, &fault, &size) == 0 && fault == 0;
        if (!there) break;
      }
    if (there) return s;
    close(s);
  }
  return -1;
}

void TrackerLink::receive(int socket) {
  if (params_.tracker_ask) {
    std::uint8_t ask[igtl_ask_bytes];
    igtl().ask(ask);
    if (send(socket, ask, sizeof ask, MSG_NOSIGNAL) != ssize_t(sizeof ask)) return;
  }
  MessageStream stream;
  double heard_s = steady_s();
  while (!stop_.load(std::memory_order_relaxed)) {
    pollfd p{socket, POLLIN, 0};
    if (poll(&p, 1, poll_ms) <= 0) {
      if (steady_s() - heard_s > dead_s) return;
      continue;
    }
    std::uint8_t bytes[1 << 14];
    const ssize_t count = recv(socket, bytes, sizeof bytes, 0);
    if (count == 0 || (count < 0 && errno != EAGAIN && errno != EINTR)) return;
    if (count < 0) continue;
    heard_s = steady_s();
    if (!stream.feed(bytes, std::size_t(count), take_)) {
      foreign_version_ = stream.version();
      return;
    }
  }
}

void TrackerLink::serve() {
  while (!stop_) {
    const int socket = connected_socket();
    if (socket >= 0) {
      const int one = 1;
      setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &one, sizeof one);
      begun_();
      ++connections_;
      receive(socket);
      close(socket);
    }
    if (!stop_) std::this_thread::sleep_for(pause);
  }
}

}  // namespace trephine::track
