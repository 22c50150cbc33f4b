// SPDX-License-Identifier: GPL-3.0-or-later
// A device behind a shared library of somebody else (adaptor.h).
#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <thread>

#include "base/error.h"
#include "base/shared_library.h"
#include "base/text.h"
#include "cli/argument.h"
#include "device/adaptor.h"
#include "device/device_type.h"
#include "device/mailbox.h"

namespace trephine::device {
namespace {

std::int64_t now_ns() {
  timespec t{};
  clock_gettime(CLOCK_MONOTONIC, &t);  // read in user space (vDSO)
  return std::int64_t(t.tv_sec) * 1000000000 + t.tv_nsec;
}

struct AdaptorParams {
  int adaptor_index = 0;
  double adaptor_timeout_ms = 50;
  template <class V>
  static void describe(V& v) {
    using P = AdaptorParams;
    v.integer(&P::adaptor_index, "adaptor_index", Range{0, 63}, "Which of the adaptor's devices, from 0.");
    v.number(&P::adaptor_timeout_ms, "adaptor_timeout_ms", Range{2, 10000},
             "Time without a pose after which the device is lost.");
  }
};

// The library and its ten functions.
struct Library : SharedLibrary {
  decltype(&trephine_adaptor_count) count = nullptr;
  decltype(&trephine_adaptor_name) name = nullptr;
  decltype(&trephine_adaptor_open) open = nullptr;
  decltype(&trephine_adaptor_limits) limits = nullptr;
  decltype(&trephine_adaptor_start) start = nullptr;
  decltype(&trephine_adaptor_read) read = nullptr;
  decltype(&trephine_adaptor_send) send = nullptr;
  decltype(&trephine_adaptor_close) close = nullptr;
  decltype(&trephine_adaptor_error) error = nullptr;

  explicit Library(const std::filesystem::path& path) : SharedLibrary(path, "trephine_adaptor_") {
    require_version(TREPHINE_ADAPTOR_VERSION);
    find("count", count);
    find("name", name);
    find("open", open);
    find("limits", limits);
    find("start", start);
    find("read", read);
    find("send", send);
    find("close", close);
    find("error", error);
  }
  [[noreturn]] void fail(const std::string& what) const { throw Error(ExitCode::io, file(), what, printable(error())); }
  std::string name_of(int index) const {
    char text[64] = {};
    if (name(index, text, int(sizeof text)) != 0) fail("name");
    text[sizeof text - 1] = 0;
    return printable(text);
  }
};

// A thread of its own calls the library, so that the servo's ticks wait for nobody.
class AdaptorDevice : public Device {
 public:
  AdaptorDevice(const std::filesystem::path& file, const AdaptorParams& params)
      : library_(file), timeout_ns_(std::int64_t(params.adaptor_timeout_ms * 1e6)) {
    const int there = library_.count();
    if (there < 0) library_.fail("count");
    if (params.adaptor_index >= there) {
      std::string names;
      for (int n = 0; n < there; ++n) names += (n > 0 ? ", " : "") + std::to_string(n) + " " + library_.name_of(n);
      throw Error(ExitCode::no_input, library_.file(), "adaptor_index",
                  std::to_string(params.adaptor_index) + ": " +
                      (there == 0 ? "no device is there" : "the devices that are there: " + names));
    }
    name_ = library_.name_of(params.adaptor_index);
    device_ = library_.open(params.adaptor_index);
    if (!device_) library_.fail("open");
    trephine_adaptor_limits_t limits{};
    if (library_.limits(device_, &limits) == 0) {
      if (limits.damping_n_s_per_mm >= 0 && limits.damping_n_s_per_mm < 1e3) damping_ = limits.damping_n_s_per_mm;
      if (limits.max_force_n > 0) max_force_n_ = limits.max_force_n;
    }
    if (library_.start(device_) != 0) {
      const std::string why = printable(library_.error());  // closing may fail, too
      library_.close(device_);
      throw Error(ExitCode::io, library_.file(), "start", why);
    }
    thread_ = std::thread([this] { serve(); });
  }
  ~AdaptorDevice() override {
    stop_ = true;
    thread_.join();
    const double none[3] = {0, 0, 0};
    library_.send(device_, none, none);
    library_.close(device_);
  }
  AdaptorDevice(const AdaptorDevice&) = delete;
  AdaptorDevice& operator=(const AdaptorDevice&) = delete;

  const std::string& name() const { return name_; }
  double max_force_n() const { return max_force_n_; }
  double damping_n_s_per_mm() const override { return damping_; }
  void wait(const Progress& progress) const {
    for (int n = 0; !connected_; ++n) {
      progress.check();
      if (failed_ || n > 2000) throw Error(ExitCode::no_input, library_.file(), name_, "gives no pose");
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  }
  bool read(double, DeviceReading& out) override {
    poses_.read(newest_);
    out = newest_.reading;
    lost_ = lost_ || failed_.load(std::memory_order_relaxed) || now_ns() - newest_.read_ns > timeout_ns_;
    return !lost_;
  }
  bool knows_across() const override { return knows_across_; }
  void tell(const DeviceNews& news) override { torque_n_mm_ = news.torque_n_mm; }
  void send(Vec3 force_n) override {
    Sent sent;
    sent.torque_n_mm = torque_n_mm_;
    // No more than the device can hold.
    const double size = norm(force_n);
    sent.force_n = size > max_force_n_ ? force_n * (max_force_n_ / size) : force_n;
    sent.sent_ns = now_ns();
    forces_.write(sent);
  }
  std::vector<std::pair<std::string, std::uint64_t>> counts() const override {
    return {{"poses", poses_read_}, {"forces", forces_sent_}};
  }

 private:
  struct Got {
    DeviceReading reading;
    std::int64_t read_ns = 0;
  };
  struct Sent {
    Vec3 force_n, torque_n_mm;
    std::int64_t sent_ns = 0;
  };

  void serve() {
    const ForceHold hold;
    Sent newest;
    while (!stop_.load(std::memory_order_relaxed)) {
      trephine_adaptor_pose pose{};
      if (library_.read(device_, &pose) != 0) {
        failed_ = true;
        break;
      }
      Got got;
      got.reading.tip_mm = {pose.tip_mm[0], pose.tip_mm[1], pose.tip_mm[2]};
      const Vec3 axis{pose.axis[0], pose.axis[1], pose.axis[2]};
      got.reading.axis =
          is_finite(axis) && norm(axis) > 0.5 ? normalized(axis) : axis;  // what is not finite is a fault
      got.reading.buttons = pose.buttons;
      const Vec3 across{pose.across[0], pose.across[1], pose.across[2]};
      if (is_finite(across) && norm(across) > 0.5) got.reading.across = normalized(across);
      if (!connected_) knows_across_ = got.reading.across != Vec3{};
      got.read_ns = now_ns();
      poses_.write(got);
      ++poses_read_;
      connected_ = true;
      forces_.read(newest);
      const double share = newest.sent_ns > 0 ? hold.share(1e-9 * double(now_ns() - newest.sent_ns)) : 0;
      const double force[3] = {newest.force_n.x * share, newest.force_n.y * share, newest.force_n.z * share};
      const Vec3 t = newest.torque_n_mm * share;
      const double torque[3] = {t.x, t.y, t.z};
      if (library_.send(device_, force, torque) != 0) {
        failed_ = true;
        break;
      }
      ++forces_sent_;
      const timespec rest{0, 400000};
      nanosleep(&rest, nullptr);
    }
  }

  const Library library_;
  std::int64_t timeout_ns_;
  void* device_ = nullptr;
  std::string name_;
  double damping_ = 0, max_force_n_ = 1e9;
  Mailbox<Got> poses_;
  Mailbox<Sent> forces_;
  Got newest_;  // the servo thread's
  Vec3 torque_n_mm_;
  bool lost_ = false;
  std::atomic<bool> stop_{false}, failed_{false}, connected_{false}, knows_across_{false};
  std::atomic<std::uint64_t> poses_read_{0}, forces_sent_{0};
  std::thread thread_;
};

}  // namespace

DeviceType adaptor_device() {
  DeviceType type;
  type.name = "adaptor";
  type.help = "a vendor's device behind a shared library";
  type.example = "--device adaptor --adaptor ./libvendor.so --seconds 60";
  type.files = {cli::argument("adaptor", cli::Argument::Kind::in_file,
                              "Shared library with the ten functions of simulator/device/adaptor.h (installed: "
                              "include/trephine/device/adaptor.h).")};
  type.groups = {cli::ParameterGroup::of<AdaptorParams>("Device behind a library")};
  type.lives = true;
  type.seat = [](const DeviceChoice& choice) {
    const auto file = choice.files.find("adaptor");
    return file == choice.files.end()
               ? std::string()
               : fmt::format("device {} of {}", choice.of<AdaptorParams>().adaptor_index, file->second.string());
  };
  type.make = [](const DeviceChoice& choice, const DeviceScene& scene) {
    auto device = std::make_unique<AdaptorDevice>(choice.files.at("adaptor"), choice.of<AdaptorParams>());
    scene.say({texts::NoteId::holding, {device->name()}});
    device->wait(scene.progress);
    return device;
  };
  return type;
}

}  // namespace trephine::device
