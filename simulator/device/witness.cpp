// SPDX-License-Identifier: GPL-3.0-or-later
#include "device/witness.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <string>
#include <thread>
#include <utility>

#include "base/error.h"
#include "device/mailbox.h"
#include "device/udp_packet.h"
#include "haptics/tool_belt.h"

namespace trephine::device {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds between_poses{1}, patience{20};
// Where this machine gave the loop no time for a while, the tool moves by more in one tick than a hand does in the few
// ms that the server grants it. The server is then told that there was a gap, by more silence than its patience
// (UdpParams): it takes no such motion for a device that jumped, and lets the tool in again as after any gap. So it is
// where the tool is taken away and put elsewhere: the one reading that says so may be gone before it is sent.
constexpr double most_step_mm = 20;
constexpr std::chrono::milliseconds gap{80};
constexpr std::chrono::seconds first_answer{30}, longest_silence{10}, last_commands{2};

/// What one thread writes and another reads in the same order.
class CommandQueue {
 public:
  /// False where it is full.
  bool push(int command) {
    const std::size_t at = end_.load(std::memory_order_relaxed);
    if (at - begin_.load(std::memory_order_acquire) == commands_.size()) return false;
    commands_[at % commands_.size()] = command;
    end_.store(at + 1, std::memory_order_release);
    return true;
  }
  bool pop(int& command) {
    const std::size_t at = begin_.load(std::memory_order_relaxed);
    if (at == end_.load(std::memory_order_acquire)) return false;
    command = commands_[at % commands_.size()];
    begin_.store(at + 1, std::memory_order_release);
    return true;
  }

 private:
  std::array<int, 256> commands_{};
  std::atomic<std::size_t> begin_{0}, end_{0};
};

class WitnessedDevice : public Device {
 public:
  WitnessedDevice(std::unique_ptr<Device> device, int port, std::uint32_t session, const std::string& flag)
      : device_(std::move(device)) {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(std::uint16_t(port));
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socket_ = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    const bool there = socket_ >= 0 && ::connect(socket_, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0;
    begin_ = Clock::now();
    pose_.session = session;
    pose_.reading.buttons = haptics::haptic_button::lifted;
    bool answered = false;
    while (there && !answered && !refused_ && Clock::now() - begin_ < first_answer) {
      // That nothing listens there is reported once, to whichever call comes next.
      if (!send_pose() && errno == ECONNREFUSED) break;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
      errno = 0;
      answered = answers() > 0;
      if (!answered && errno == ECONNREFUSED) break;
    }
    if (!answered) {
      if (socket_ >= 0) ::close(socket_);
      const std::string where = "at port " + std::to_string(port) + " of this machine";
      throw Error(ExitCode::io, "", flag,
                  refused_ ? "the record server " + where +
                                 " is for another participant, task, case, rubric or second hand (--second-port, "
                                 "--second-tool), or is held by another window: start `trephine-sim record-server` "
                                 "with what this lesson has"
                           : "nobody answers " + where + ": start `trephine-sim record-server` first");
    }
    thread_ = std::thread([this] { serve(); });
  }
  ~WitnessedDevice() override {
    stop_ = true;
    thread_.join();
    ::close(socket_);
  }

  double damping_n_s_per_mm() const override { return device_->damping_n_s_per_mm(); }
  bool knows_across() const override { return device_->knows_across(); }
  bool read(double dt_s, DeviceReading& out) override {
    const bool there = device_->read(dt_s, out);
    if (there && !out.silent) {
      const int command = haptics::belt_button::command(out.buttons);
      if (command != given_ && !commands_.push(given_ = command)) silent_now_ = true;  // nothing may be forgotten
      if (seen_ && norm(out.tip_mm - last_mm_) > most_step_mm)
        quiet_until_.store((Clock::now() + gap).time_since_epoch(), std::memory_order_relaxed);
      seen_ = true;
      last_mm_ = out.tip_mm;
      readings_.write(out);
    }
    return there && !silent_now_.load(std::memory_order_relaxed);
  }
  void send(Vec3 force_n) override { device_->send(force_n); }
  void tell(const DeviceNews& news) override { device_->tell(news); }
  std::vector<std::pair<std::string, std::uint64_t>> counts() const override { return device_->counts(); }

 private:
  bool send_pose() {
    namespace button = haptics::belt_button;
    const std::uint32_t buttons = pose_.reading.buttons;
    ++pose_.sequence;
    pose_.time_s = std::chrono::duration<double>(Clock::now() - begin_).count();
    pose_.lifted = (buttons & haptics::haptic_button::lifted) != 0;
    pose_.pedals = buttons & (haptics::Drilling::pedal | haptics::Drilling::mark);
    pose_.tool = button::tool(buttons);
    pose_.command = command_;
    const UdpBytes packet = encode_pose(pose_);
    return ::send(socket_, packet.data(), packet.size(), MSG_DONTWAIT | MSG_NOSIGNAL) == ssize_t(packet.size());
  }
  // The last pose that was answered since the last call; 0: none.
  std::uint64_t answers() {
    std::uint8_t bytes[512];
    std::uint64_t last = 0;
    for (ssize_t count; (count = ::recv(socket_, bytes, sizeof bytes, MSG_DONTWAIT)) > 0;) {
      UdpForce force;
      if (!decode_force(bytes, std::size_t(count), force) || force.session != pose_.session) continue;
      if (force.busy)
        refused_ = true;
      else
        last = std::max(last, force.answers);
    }
    return last;
  }
  void serve() {
    ::prctl(PR_SET_TIMERSLACK, 1000);
    Clock::time_point next = Clock::now(), read = next - patience, waits_since, end;
    std::uint64_t command_since = 0;  // the first pose with this command
    bool waits = false, taken = true, ending = false;
    for (;;) {
      if (stop_ && !std::exchange(ending, true)) end = Clock::now() + last_commands;
      if (readings_.read(pose_.reading)) read = Clock::now();
      // The server takes the newest pose of each of its ticks. So a command stays until one of them took it.
      if (const std::uint64_t answered = answers(); answered > 0) {
        waits = false;
        taken = taken || answered >= command_since;
      }
      // Then it is let go at once: a command that were still held after a gap would act once more.
      const bool held = taken && std::exchange(command_, 0) != 0;
      if (held || (taken && commands_.pop(command_))) {
        taken = false;
        command_since = pose_.sequence + 1;
      }
      if (ending && (taken || Clock::now() > end)) return;
      pose_.reading.across = haptics::usable_across(pose_.reading.across, pose_.reading.axis);
      const bool quiet = Clock::now().time_since_epoch() < quiet_until_.load(std::memory_order_relaxed);
      if (ending || (!quiet && Clock::now() - read < patience)) {  // else the device is silent, as the server will find
        send_pose();
        if (!std::exchange(waits, true)) waits_since = Clock::now();
      }
      if (waits && Clock::now() - waits_since > longest_silence) silent_now_ = true;
      std::this_thread::sleep_until(next = std::max(next + between_poses, Clock::now()));
    }
  }

  const std::unique_ptr<Device> device_;
  int socket_ = -1;
  Clock::time_point begin_;
  UdpPose pose_;  // the thread's, once it runs
  Mailbox<DeviceReading> readings_;
  CommandQueue commands_;
  int given_ = 0, command_ = 0;  // the servo thread's; the one that is sent
  Vec3 last_mm_;                 // the servo thread's
  bool seen_ = false;
  std::atomic<Clock::duration> quiet_until_{Clock::duration::zero()};
  bool refused_ = false;
  std::atomic<bool> stop_{false}, silent_now_{false};
  std::thread thread_;
};

}  // namespace

std::unique_ptr<Device> with_witness(std::unique_ptr<Device> device, int port, std::uint32_t session,
                                     const std::string& flag) {
  return std::make_unique<WitnessedDevice>(std::move(device), port, session, flag);
}

}  // namespace trephine::device
