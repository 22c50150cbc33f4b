// SPDX-License-Identifier: GPL-3.0-or-later
// A gamepad, read from Linux's event device by a thread of its own: it is as quick as the servo loop however slowly
// pictures are drawn, and works without a window. Axes and buttons are those of the kernel's gamepad protocol
// (Documentation/input/gamepad.rst).
#include <fcntl.h>
#include <linux/input.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <map>
#include <thread>

#include "base/error.h"
#include "base/text.h"
#include "device/rate_hand.h"

namespace trephine {
namespace {

struct GamepadParams {
  std::string gamepad;
  template <class V>
  static void describe(V& v) {
    using P = GamepadParams;
    v.text(&P::gamepad, "gamepad",
           "Its event device, such as /dev/input/event7; empty: the first gamepad that is there.");
  }
};

template <std::size_t bits>
using Bits = std::array<std::uint8_t, bits / 8 + 1>;
template <class B>
bool has(const B& bits, int n) {
  return bits[std::size_t(n / 8)] >> (n % 8) & 1;
}

constexpr int axes[] = {ABS_X, ABS_Y, ABS_Z, ABS_RX, ABS_RY, ABS_RZ, ABS_GAS, ABS_BRAKE};
// Button 1 of the device, and so on.
constexpr int buttons[] = {BTN_SOUTH, BTN_EAST, BTN_WEST, BTN_NORTH, BTN_TL, BTN_TR, BTN_SELECT, BTN_START};

// What one event device is, and how it is held now.
class Pad {
 public:
  explicit Pad(const std::string& file) : descriptor_(::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC)) {
    if (descriptor_ < 0) fault_ = std::strerror(errno);
    Bits<KEY_MAX> keys{};
    if (fault_.empty() &&
        (::ioctl(descriptor_, EVIOCGBIT(EV_KEY, keys.size()), keys.data()) < 0 || !has(keys, BTN_GAMEPAD)))
      fault_ = "is no gamepad";
    if (!fault_.empty()) return;
    char name[128] = "";
    if (::ioctl(descriptor_, EVIOCGNAME(sizeof name - 1), name) >= 0) name_ = printable(name);
    for (const int axis : axes) {
      input_absinfo info{};
      if (::ioctl(descriptor_, EVIOCGABS(axis), &info) >= 0 && info.maximum > info.minimum) axis_[axis] = info;
    }
    look();
  }
  ~Pad() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  Pad(const Pad&) = delete;
  Pad& operator=(const Pad&) = delete;
  const std::string& fault() const { return fault_; }
  const std::string& name() const { return name_; }

  // Waits for events, at most so long. Returns false where the gamepad is gone.
  bool wait(int ms) {
    pollfd p{descriptor_, POLLIN, 0};
    if (::poll(&p, 1, ms) <= 0) return true;
    input_event events[32];
    const ssize_t n = ::read(descriptor_, events, sizeof events);
    if (n <= 0) return n < 0 && (errno == EAGAIN || errno == EINTR);
    for (std::size_t k = 0; k < std::size_t(n) / sizeof *events; ++k) take(events[k]);
    return true;
  }

  // Left stick: in the picture's plane. Right trigger: along the tool; left: back. Right stick: tilts the tool.
  Push push() const {
    // Gamepads without a driver of their own have the right stick where others have the triggers.
    const bool usual = axis_.count(ABS_RX) != 0;
    const auto trigger = [&](int analog, int digital) {
      const auto found = axis_.find(analog);
      const double pressed = found == axis_.end() ? 0 : share(found->second);
      return std::max(pressed, down(digital) ? 1.0 : 0.0);
    };
    Push p;
    p.move = {stick(ABS_X), -stick(ABS_Y), 0};
    p.turn = {stick(usual ? ABS_RY : ABS_RZ), stick(usual ? ABS_RX : ABS_Z), 0};
    p.ahead = trigger(usual ? ABS_RZ : ABS_GAS, BTN_TR2) - trigger(usual ? ABS_Z : ABS_BRAKE, BTN_TL2);
    for (std::size_t n = 0; n < std::size(buttons); ++n)
      if (down(buttons[n])) p.buttons |= std::uint32_t{1} << n;
    return p;
  }

 private:
  static double share(const input_absinfo& i) {
    return std::clamp((double(i.value) - i.minimum) / (double(i.maximum) - i.minimum), 0.0, 1.0);
  }
  double stick(int axis) const {
    const auto found = axis_.find(axis);
    return found == axis_.end() ? 0 : 2 * share(found->second) - 1;
  }
  bool down(int key) const { return has(down_, key); }

  // As all of it is held now: at the start, and where the kernel had to drop events.
  void look() {
    for (auto& [axis, info] : axis_) {
      input_absinfo now{};
      if (::ioctl(descriptor_, EVIOCGABS(axis), &now) >= 0) info.value = now.value;
    }
    if (::ioctl(descriptor_, EVIOCGKEY(down_.size()), down_.data()) < 0) down_.fill(0);
  }
  void take(const input_event& e) {
    if (e.type == EV_SYN && e.code == SYN_DROPPED) look();
    if (e.type == EV_ABS)
      if (const auto found = axis_.find(e.code); found != axis_.end()) found->second.value = e.value;
    if (e.type == EV_KEY && e.code < KEY_MAX) {
      std::uint8_t& byte = down_[std::size_t(e.code / 8)];
      const auto bit = std::uint8_t(1u << (e.code % 8));
      byte = std::uint8_t(e.value != 0 ? byte | bit : byte & ~bit);
    }
  }

  const int descriptor_;
  std::string fault_, name_ = "gamepad";
  std::map<int, input_absinfo> axis_;
  Bits<KEY_MAX> down_{};
};

// The event devices in the order of their numbers; those that are no gamepads, or nobody may read, are passed over.
std::unique_ptr<Pad> first_pad() {
  int closed = 0;
  for (int n = 0; n < 256; ++n) {
    const std::string file = "/dev/input/event" + std::to_string(n);
    if (::access(file.c_str(), F_OK) != 0) continue;
    if (::access(file.c_str(), R_OK) != 0) {
      ++closed;
      continue;
    }
    auto pad = std::make_unique<Pad>(file);
    if (pad->fault().empty()) return pad;
  }
  throw Error(ExitCode::no_input, "", "--device gamepad",
              closed == 0 ? "no gamepad is there: plug one in, or name its file by --gamepad /dev/input/eventN"
                          : "no gamepad is there that you may read, and " + std::to_string(closed) +
                                " of /dev/input/event* may not be read: plug one in, or join the group `input` "
                                "(usermod -aG input NAME, then log in anew)");
}

class Gamepad : public RateHand {
 public:
  Gamepad(std::unique_ptr<Pad> pad, const RateHandParams& params, const DeviceScene& scene)
      : RateHand(params, scene), pad_(std::move(pad)) {
    push(pad_->push());
    thread_ = std::thread([this] {
      while (!stop_.load(std::memory_order_relaxed)) {
        if (!pad_->wait(20)) {
          lose();
          return;
        }
        push(pad_->push());
      }
    });
  }
  ~Gamepad() override {
    stop_ = true;
    thread_.join();
  }

 private:
  const std::unique_ptr<Pad> pad_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace

DeviceType gamepad_device() {
  DeviceType type;
  type.name = "gamepad";
  type.help = "a gamepad, whose sticks and triggers move and tilt the tool";
  type.example = "--device gamepad --seconds 60";
  type.groups = {ParameterGroup::of<GamepadParams>("Gamepad"),
                 ParameterGroup::of<RateHandParams>("Gamepad and 3D mouse")};
  type.lives = true;
  type.make = [](const DeviceChoice& choice, const DeviceScene& scene) -> std::unique_ptr<Device> {
    const std::string file = choice.of<GamepadParams>().gamepad;
    std::unique_ptr<Pad> pad;
    if (file.empty()) {
      pad = first_pad();
    } else {
      pad = std::make_unique<Pad>(file);
      if (!pad->fault().empty()) throw Error(ExitCode::no_input, file, "--gamepad", pad->fault());
    }
    scene.say("holding " + pad->name());
    return std::make_unique<Gamepad>(std::move(pad), choice.of<RateHandParams>(), scene);
  };
  return type;
}

}  // namespace trephine
