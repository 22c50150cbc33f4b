// SPDX-License-Identifier: GPL-3.0-or-later
// A 3D mouse through libspnav and its daemon spacenavd. The library is loaded where it is installed, so that nothing
// needs it to build or to run without such a mouse.
#include <dlfcn.h>
#include <poll.h>

#include <thread>

#include "base/error.h"
#include "device/rate_hand.h"
#include "device/spnav_abi.h"

namespace trephine::device {
namespace {

constexpr double full_push = 350;  // what a 3D mouse says at its end, at spacenavd's usual sensitivity

struct Library {
  decltype(&spnav_abi::spnav_open) open = nullptr;
  decltype(&spnav_abi::spnav_close) close = nullptr;
  decltype(&spnav_abi::spnav_fd) fd = nullptr;
  decltype(&spnav_abi::spnav_poll_event) poll_event = nullptr;

  Library() {
    void* handle = ::dlopen("libspnav.so.0", RTLD_NOW | RTLD_LOCAL);
    if (!handle)
      fail("libspnav.so.0 is not installed: install it and the daemon (Debian: apt install libspnav0 spacenavd)");
    find(handle, "spnav_open", open);
    find(handle, "spnav_close", close);
    find(handle, "spnav_fd", fd);
    find(handle, "spnav_poll_event", poll_event);
  }
  [[noreturn]] static void fail(const std::string& what) {
    throw Error(ExitCode::no_input, "", "--device spacemouse", what);
  }
  template <class F>
  static void find(void* handle, const char* name, F& function) {
    function = reinterpret_cast<F>(::dlsym(handle, name));
    if (!function) fail(std::string("libspnav.so.0 has no ") + name);
  }
};

class Spacemouse : public RateHand {
 public:
  Spacemouse(const RateHandParams& params, const DeviceScene& scene) : RateHand(params, scene) {
    if (library_.open() == -1)
      Library::fail(
          "the daemon spacenavd does not answer: plug the 3D mouse in and start it (Debian: systemctl start "
          "spacenavd)");
    thread_ = std::thread([this] { follow(); });
  }
  ~Spacemouse() override {
    stop_ = true;
    thread_.join();
    library_.close();
  }

 private:
  void follow() {
    while (!stop_.load(std::memory_order_relaxed)) {
      pollfd p{library_.fd(), POLLIN, 0};
      if (::poll(&p, 1, 20) <= 0) continue;
      spnav_abi::Event e{};
      bool any = false;
      while (library_.poll_event(&e) != 0) {
        take(e);
        any = true;
      }
      if (any) push(push_);
      if (!any && (p.revents & (POLLHUP | POLLERR | POLLNVAL))) {
        lose();
        return;
      }
    }
  }
  // spacenavd's z is positive away from the user, so a turn's vector is mirrored with it.
  void take(const spnav_abi::Event& e) {
    if (e.type == spnav_abi::motion) {
      const auto part = [](int v) { return v / full_push; };
      push_.move = {part(e.motion.x), part(e.motion.y), -part(e.motion.z)};
      push_.turn = {part(e.motion.rx), part(e.motion.ry), -part(e.motion.rz)};
    } else if (e.type == spnav_abi::button && e.button.number >= 0 && e.button.number < 8) {
      const std::uint32_t bit = std::uint32_t{1} << e.button.number;
      push_.buttons = e.button.press ? push_.buttons | bit : push_.buttons & ~bit;
    }
  }

  const Library library_;
  Push push_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace

DeviceType spacemouse_device() {
  DeviceType type;
  type.name = "spacemouse";
  type.help = "a 3D mouse behind spacenavd, which moves and turns the tool as it is pushed and turned";
  type.example = "--device spacemouse --seconds 60";
  type.lives = true;
  type.seat = [](const DeviceChoice&) { return std::string("the 3D mouse"); };
  type.make = [](const DeviceChoice& choice, const DeviceScene& scene) -> std::unique_ptr<Device> {
    auto device = std::make_unique<Spacemouse>(choice.of<RateHandParams>(), scene);
    scene.say(texts::NoteId::holding_mouse_3d);
    return device;
  };
  return type;
}

}  // namespace trephine::device
