// SPDX-License-Identifier: GPL-3.0-or-later
// A gamepad, read from Linux's event device by a thread of its own: it is as quick as the servo loop however slowly
// pictures are drawn, and works without a window.
#include <fcntl.h>
#include <linux/input.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <optional>
#include <thread>

#include "base/error.h"
#include "base/text.h"
#include "device/pad_state.h"
#include "device/rate_hand.h"

namespace trephine::device {
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

// What one event device is, and how it is held now.
class Pad : public PadSource {
 public:
  explicit Pad(const std::string& file) : descriptor_(::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC)) {
    if (descriptor_ < 0) fault_ = std::strerror(errno);
    PadKeys there{};
    if (fault_.empty() &&
        (::ioctl(descriptor_, EVIOCGBIT(EV_KEY, there.size()), there.data()) < 0 || !is_down(there, BTN_GAMEPAD)))
      fault_ = "is no gamepad";
    if (!fault_.empty()) return;
    char name[128] = "";
    if (::ioctl(descriptor_, EVIOCGNAME(sizeof name - 1), name) >= 0) name_ = printable(name);
    state_.emplace(*this);
  }
  ~Pad() override {
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
    for (std::size_t k = 0; k < std::size_t(n) / sizeof *events; ++k) state_->take(events[k]);
    return true;
  }

  // Of a pad without a fault.
  Push push() const { return state_->push(); }

  bool axis(int code, input_absinfo& out) const override { return ::ioctl(descriptor_, EVIOCGABS(code), &out) >= 0; }
  bool keys(PadKeys& out) const override { return ::ioctl(descriptor_, EVIOCGKEY(out.size()), out.data()) >= 0; }

 private:
  const int descriptor_;
  std::string fault_, name_ = "gamepad";
  std::optional<PadState> state_;
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
  type.groups = {cli::ParameterGroup::of<GamepadParams>("Gamepad"),
                 cli::ParameterGroup::of<RateHandParams>("Gamepad and 3D mouse")};
  type.lives = true;
  type.seat = [](const DeviceChoice& choice) {
    const std::string file = choice.of<GamepadParams>().gamepad;
    return file.empty() ? "the first gamepad" : "the gamepad " + file;
  };
  type.make = [](const DeviceChoice& choice, const DeviceScene& scene) -> std::unique_ptr<Device> {
    const std::string file = choice.of<GamepadParams>().gamepad;
    std::unique_ptr<Pad> pad;
    if (file.empty()) {
      pad = first_pad();
    } else {
      pad = std::make_unique<Pad>(file);
      if (!pad->fault().empty()) throw Error(ExitCode::no_input, file, "--gamepad", pad->fault());
    }
    scene.say({texts::NoteId::holding, {pad->name()}});
    return std::make_unique<Gamepad>(std::move(pad), choice.of<RateHandParams>(), scene);
  };
  return type;
}

}  // namespace trephine::device
