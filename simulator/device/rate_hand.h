// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <atomic>
#include <cstdint>
#include <memory>

#include "base/params.h"
#include "device/device.h"
#include "device/device_type.h"
#include "device/led_hand.h"
#include "device/mailbox.h"

namespace trephine::device {

/// How a device moves the tool that is pushed out of its middle and springs back: gamepad and 3D mouse.
struct RateHandParams {
  double push_mm_per_s = 30, push_deg_per_s = 60, push_dead_ratio = 0.1;
  double push_stiffness_n_per_mm = 0.4, push_most_n = 2.2;
  template <class V>
  static void describe(V& v) {
    using P = RateHandParams;
    v.number(&P::push_mm_per_s, "push_mm_per_s", Range{0.1, 500},
             "Speed of the tool where the device is pushed fully; it grows with the square of the push.");
    v.number(&P::push_deg_per_s, "push_deg_per_s", Range{0, 720}, "Speed of turning the tool, likewise.");
    v.number(&P::push_dead_ratio, "push_dead_ratio", Range{0, 0.9}, "Share of the push that does nothing.");
    v.number(&P::push_stiffness_n_per_mm, "push_stiffness_n_per_mm", Range{0.01, 5},
             "How firmly the hand follows: surfaces and bone hold it back by this force for each mm.");
    v.number(&P::push_most_n, "push_most_n", Range{0.1, 50},
             "It never pulls harder; with a needle for bone, as hard as that needs.");
  }
};

/// What is pushed, each from -1 to 1, in the picture's axes: to the right, upwards, towards the viewer.
struct Push {
  Vec3 move, turn;   ///< turn: about these axes, right-handed
  double ahead = 0;  ///< along the tool
  std::uint32_t buttons = 0;
};

/// Moves a hand by what is pushed: mm and degrees a second in the picture's axes, and a mass on a spring that feels the
/// force, so that the tool is pressed no harder than `push_most_n`. Its goal stays within reach: a tool that bone held
/// back goes on by that reach (1.2 push_most_n / push_stiffness_n_per_mm, 6.6 mm) when the bone is gone, and no
/// further. Whoever reads the device calls push() and lose(), from one thread.
class RateHand : public Device {
 public:
  RateHand(const RateHandParams& params, const DeviceScene& scene);
  void push(const Push& push) { pushes_.write(push); }
  void lose() { lost_ = true; }

  double damping_n_s_per_mm() const override { return own_damping; }
  bool read(double dt_s, DeviceReading& out) override;
  void send(Vec3 force_n) override { hand_.feel(force_n); }

 private:
  static constexpr double own_damping = 0.002;
  double speed(double push) const;
  Vec3 speed(Vec3 push) const { return {speed(push.x), speed(push.y), speed(push.z)}; }
  RateHandParams params_;
  std::shared_ptr<Mailbox<ViewAxes>> view_;
  Mailbox<Push> pushes_;
  std::atomic<bool> lost_{false};
  ViewAxes axes_;
  Push push_;
  LedHand hand_;
  Vec3 goal_mm_, axis_goal_, axis_;
};

/// Where a hand begins: where the scene says, else above the middle of the volume, pointing down.
HandBegin begin_of(const DeviceScene& scene);

}  // namespace trephine::device
