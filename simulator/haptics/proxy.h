// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>

#include "haptics/force_ease.h"
#include "haptics/force_slew.h"
#include "haptics/haptic_state.h"
#include "haptics/proxy_body.h"
#include "haptics/tool.h"
#include "haptics/tool_body.h"
#include "tissue/bent_shaft.h"
#include "tissue/cutting_tip.h"
#include "tissue/shaft_friction.h"
#include "touch/entered_line.h"

namespace trephine::haptics {

/// A point that the surfaces of a haptic volume hold back, and the resulting force [Zilles1995], with the friction of
/// [Ruspini1997]. Each frame the proxy moves towards the device. Every part of its way is checked by
/// ContactVolume::intersect, so it crosses no touchable face. Each surface that it meets becomes a tangent plane.
/// Before up to three such planes the proxy takes the point nearest to the device, less what the friction cone holds
/// back.
///
/// A face whose spring force exceeds its pop_through_n lets the proxy in; then the shape's drag and shaft friction act
/// until the proxy has left. A tool that starts inside a shape that nothing can enter is moved to the nearest surface
/// of that shape. A tool of many points may take some frames to find that surface, and gives no force until then.
///
/// With a tool of many points [Rizzi, chapter 5] the proxy is the whole tool: the way of each point is walked, so no
/// point crosses a touchable face, and a surface that any point meets is a plane for the tip. The tool turns with the
/// device as far as its points may, and where only one wall is in the way the tip gives way. A shape that one point
/// popped into is open to the other points until the tool's axis no longer passes through it.
///
/// A tip that has entered a shape of FeltSpace::line_lock holds the tool on its line (touch/entered_line.h): the hand
/// is felt as if it were on that line, and the wall of the hole, as stiff and damped as the shape's front, presses it
/// back, through the shaft where that bends (tissue/bent_shaft.h).
///
/// The springs of a shape whose material relaxes do (tissue/relaxation.h), and a face then gives way at the force that
/// is felt. A tip that has entered cuts its way on (tissue/cutting_tip.h).
///
/// The force changes by at most ForceParams::force_rate_n_per_s() times the loop's period a frame, however long the
/// frame was. After a stall it starts from what the device still holds (ForceHold).
///
/// The torque on the hand about the tip is that of the surfaces' forces where they press, and, where surfaces keep the
/// tool from turning with the device, that of a spring between the two orientations. It has limits as the force has,
/// and is 0 where the force is 0 for a fault.
///
/// While HapticInput::away is set the force falls to zero as fast as it may change. While the button
/// haptic_button::lifted is down there is neither contact nor force, and the tool is shown at the device; then it
/// starts again.
///
/// A round tool (Tool::round) is exactly round: the proxy holds the middle lines of its parts off all surfaces by their
/// radii (RoundBody). A ball alone turns with the device. Another round tool turns as far as surfaces let it, where its
/// tip may give way; it does not lock, and for a fast turn it takes some frames.
///
/// update() does not allocate, lock or throw and makes no system call; equal inputs give equal bits.
class Proxy {
 public:
  /// What `space` refers to must outlive it.
  Proxy(const touch::FeltSpace& space, const Feels& feels, const ForceParams& force, const ShaftParams& shaft = {},
        const Tool& tool = {});
  Proxy(const Proxy&) = delete;

  /// A pose, axis or time step that is not finite, or a step that is not in (0, 1] s, is a fault: the force is exactly
  /// 0 from then on, until reset().
  const HapticState& update(const HapticInput& given);
  /// Latches a fault from outside, such as a lost device.
  void latch(std::uint32_t fault);
  /// Starts again: the next update places the proxy, and forces rise from 0.
  void reset();
  const HapticState& state() const { return ground_.state; }
  /// Changes of the force that were smoothed so far.
  std::uint64_t eased() const { return ease_.count(); }
  /// Where each point of the tool is shown; null where it has none.
  const ToolBody* tool_body() const { return body_->points(); }

 private:
  void rest_at(const HapticInput& in);
  void begin(const HapticInput& in);
  void note_motion(const HapticInput& in);
  Vec3 force_of(const HapticInput& in);
  Vec3 surface_force(Vec3 held_mm, Vec3 device_mm);
  Vec3 inside_force(const HapticInput& in);
  void set_torque(const HapticInput& in, Vec3 before);
  void note_events(const HapticState& before);
  void note_line();
  Vec3 line_force(Vec3 hand_mm) const;

  ForceParams force_;
  ProxyGround ground_;
  std::unique_ptr<ProxyBody> body_;
  bool begun_ = false;
  double stiffest_n_per_mm_ = 0;
  double since_s_ = 0, moved_mm_ = 0;  // since it began; of the device in this frame
  Vec3 device_mm_, velocity_, moved_from_mm_;
  Vec3 pressed_n_mm_;  // torque of the surfaces of this frame
  Vec3 off_line_mm_;   // from the hand to the line that holds the tool
  touch::EnteredLine line_;
  tissue::ShaftFriction shaft_;
  tissue::BentShaft bent_;
  tissue::CuttingTip tip_;
  ForceEase ease_;
  ForceSlew slew_;
};

}  // namespace trephine::haptics
