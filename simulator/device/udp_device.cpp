// SPDX-License-Identifier: GPL-3.0-or-later
#include "device/udp_device.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <pthread.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>

#include "base/error.h"
#include "device/device_type.h"

namespace trephine::device {
namespace {

constexpr long answer_poll_ns = 100000, idle_poll_ns = 20000000;

struct Address {
  sockaddr_storage bytes{};
  socklen_t length = 0;
  bool operator==(const Address& o) const { return length == o.length && std::memcmp(&bytes, &o.bytes, length) == 0; }
  sockaddr* get() { return reinterpret_cast<sockaddr*>(&bytes); }
};

bool parse_address(const std::string& text, int port, Address& out) {
  sockaddr_in four{};
  if (inet_pton(AF_INET, text.c_str(), &four.sin_addr) == 1) {
    four.sin_family = AF_INET;
    four.sin_port = htons(std::uint16_t(port));
    out.length = sizeof four;
    std::memcpy(&out.bytes, &four, sizeof four);
    return true;
  }
  sockaddr_in6 six{};
  if (inet_pton(AF_INET6, text.c_str(), &six.sin6_addr) != 1) return false;
  six.sin6_family = AF_INET6;
  six.sin6_port = htons(std::uint16_t(port));
  out.length = sizeof six;
  std::memcpy(&out.bytes, &six, sizeof six);
  return true;
}

int port_of(const Address& a) {
  sockaddr_in four{};
  sockaddr_in6 six{};
  if (a.bytes.ss_family == AF_INET6) {
    std::memcpy(&six, &a.bytes, sizeof six);
    return ntohs(six.sin6_port);
  }
  std::memcpy(&four, &a.bytes, sizeof four);
  return ntohs(four.sin_port);
}

}  // namespace

std::int64_t UdpDevice::monotonic_ns() {
  timespec t{};
  clock_gettime(CLOCK_MONOTONIC, &t);  // read in user space (vDSO)
  return std::int64_t(t.tv_sec) * 1000000000 + t.tv_nsec;
}

struct UdpDevice::Network {
  int socket = -1;
  bool realtime = false;
  Address client;
  std::uint32_t session = 0;
  std::uint64_t last = 0, answered = 0;  // sequences
  std::int64_t heard_ns = 0;
  bool there = false, lost = false;
  ~Network() {
    if (socket >= 0) close(socket);
  }
};

UdpDevice::UdpDevice(const UdpParams& params, bool realtime, Clock clock, std::uint32_t only_session)
    : params_(params),
      timeout_ns_(std::int64_t(params.timeout_ms * 1e6)),
      lost_ns_(timeout_ns_ + std::int64_t(params.resume_s * 1e9)),
      clock_(clock),
      only_session_(only_session),
      network_(std::make_unique<Network>()) {
  Address at;
  if (!parse_address(params.address, params.port, at))
    throw Error(ExitCode::usage, "", "address", params.address + " is no address in numbers");
  const bool six = at.bytes.ss_family == AF_INET6;
  const std::string host = six ? "[" + params.address + "]" : params.address;
  network_->realtime = realtime;
  network_->socket = socket(at.bytes.ss_family, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (network_->socket < 0 || bind(network_->socket, at.get(), at.length) != 0 ||
      getsockname(network_->socket, at.get(), &at.length) != 0)
    throw Error(ExitCode::io, "", "port", host + ":" + std::to_string(params.port) + ": " + std::strerror(errno));
  port_ = port_of(at);
  endpoint_ = host + ":" + std::to_string(port_);
  thread_ = std::thread([this] { serve(); });
}

UdpDevice::~UdpDevice() {
  stop_ = true;
  thread_.join();
}

void UdpDevice::wait(const Progress& progress) const {
  const std::int64_t begin = monotonic_ns();
  while (!connected_) {
    progress.check();
    if (params_.wait_s > 0 && double(monotonic_ns() - begin) > 1e9 * params_.wait_s)
      throw Error(ExitCode::no_input, "", "device", "no pose came to " + endpoint_);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

bool UdpDevice::read(double, DeviceReading& out) {
  if (poses_.read(newest_)) known_ = true;
  out = newest_.pose.reading;
  const std::int64_t age_ns = clock_() - newest_.received_ns;
  lost_ = lost_ || !known_ || newest_.lost || age_ns > lost_ns_;
  out.silent = !lost_ && age_ns > timeout_ns_;
  if (out.silent && !silent_) gaps_.fetch_add(1, std::memory_order_relaxed);
  silent_ = out.silent;
  return !lost_;
}

void UdpDevice::tell(const DeviceNews& news) {
  answer_.news = news;
  answer_.news.events = 0;  // they are kept until they were told
  if (news.events != 0) events_.fetch_or(news.events, std::memory_order_relaxed);
}

void UdpDevice::send(Vec3 force_n) {
  answer_.version = newest_.pose.version;
  answer_.force_n = force_n;
  answer_.session = newest_.pose.session;
  answer_.answers = newest_.pose.sequence;
  answer_.pose_time_s = newest_.pose.time_s;
  forces_.write(answer_);
}

std::vector<std::pair<std::string, std::uint64_t>> UdpDevice::counts() const {
  return {{"poses", taken_}, {"answers", answers_},     {"malformed", malformed_},
          {"late", late_},   {"strangers", strangers_}, {"gaps", gaps_}};
}

void UdpDevice::serve() {
  prctl(PR_SET_TIMERSLACK, 1000);
  Network& net = *network_;
  if (net.realtime) {
    sched_param p{};
    p.sched_priority = 79;
    pthread_setschedparam(pthread_self(), SCHED_FIFO, &p);
  }
  const auto reply = [&](const UdpForce& f, Address& to) {
    const UdpBytes packet = encode_force(f);
    return sendto(net.socket, packet.data(), packet.size(), MSG_DONTWAIT | MSG_NOSIGNAL, to.get(), to.length) ==
           ssize_t(packet.size());
  };
  const auto take = [&](const std::uint8_t* bytes, std::size_t count, Address& from) {
    Incoming in;
    if (!decode_pose(bytes, count, in.pose)) {
      ++malformed_;
      return;
    }
    in.received_ns = clock_();
    const bool same = net.there && from == net.client && in.pose.session == net.session;
    const bool silent = net.there && in.received_ns - net.heard_ns > timeout_ns_;
    const bool gone = silent && (!same || in.received_ns - net.heard_ns > lost_ns_);
    const bool other_lesson = only_session_ != 0 && in.pose.session != only_session_;
    if (other_lesson || (net.there && !same && !silent)) {
      ++strangers_;
      UdpForce busy;
      busy.version = in.pose.version;
      busy.busy = true;
      busy.session = in.pose.session;
      busy.answers = in.pose.sequence;
      busy.pose_time_s = in.pose.time_s;
      reply(busy, from);
      return;
    }
    // How a recording is laid out is decided by the first pose of all.
    const int version = version_;
    if (version != 0 && in.pose.version != version && !net.lost && !gone) {
      ++malformed_;
      return;
    }
    if (same && in.pose.sequence <= net.last) {
      ++late_;
      return;
    }
    net.lost = in.lost = net.lost || gone;
    if (!same) {
      net.client = from;
      net.session = in.pose.session;
      net.answered = 0;
    }
    net.there = true;
    net.heard_ns = in.received_ns;
    net.last = in.pose.sequence;
    ++taken_;
    if (version == 0) version_ = in.pose.version;
    poses_.write(in);
    connected_ = true;
  };
  UdpForce newest;
  while (!stop_.load(std::memory_order_relaxed)) {
    pollfd p{net.socket, POLLIN, 0};
    const timespec patience{0, net.answered < net.last ? answer_poll_ns : idle_poll_ns};
    ppoll(&p, 1, &patience, nullptr);
    for (int n = 0; n < 64; ++n) {  // whatever pours in, answers go out
      std::uint8_t bytes[2048];
      Address from;
      from.length = sizeof from.bytes;
      const ssize_t count = recvfrom(net.socket, bytes, sizeof bytes, MSG_DONTWAIT, from.get(), &from.length);
      if (count < 0) break;
      take(bytes, std::size_t(count), from);
    }
    forces_.read(newest);
    if (newest.session != net.session || newest.answers <= net.answered || newest.answers > net.last) continue;
    net.answered = newest.answers;
    newest.news.events |= events_.exchange(0, std::memory_order_relaxed);
    ++answers_;  // before it is sent: who has an answer in hand finds it counted
    if (!reply(newest, net.client)) --answers_;
  }
}

DeviceType udp_device() {
  DeviceType type;
  type.name = "udp";
  type.help = "one that sends its poses by UDP";
  type.example = "--device udp --port 20517 --seconds 60";
  type.groups = {cli::ParameterGroup::of<UdpParams>("Device by UDP")};
  type.lives = true;
  type.seat = [](const DeviceChoice& choice) {
    const int port = choice.of<UdpParams>().port;
    return port == 0 ? std::string() : "UDP port " + std::to_string(port);
  };
  type.make = [](const DeviceChoice& choice, const DeviceScene& scene) {
    auto device = std::make_unique<UdpDevice>(choice.of<UdpParams>(), scene.realtime);
    scene.say({texts::NoteId::waiting_for_device, {device->endpoint()}});
    device->wait(scene.progress);
    return device;
  };
  return type;
}

}  // namespace trephine::device
