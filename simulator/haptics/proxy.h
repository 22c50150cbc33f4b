// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <optional>
#include <string>

#include "base/vec3.h"
#include "contact/constraints.h"
#include "contact/contact.h"
#include "haptics/feel.h"
#include "haptics/force_ease.h"
#include "haptics/force_slew.h"
#include "haptics/held_surfaces.h"
#include "haptics/round_body.h"
#include "haptics/shaft_friction.h"
#include "haptics/sliding_friction.h"
#include "haptics/tool.h"
#include "haptics/tool_body.h"
#include "haptics/way_out.h"

namespace trephine::haptics {

/// The pose of a device in one frame.
struct HapticInput {
  Vec3 tip_mm;
  Vec3 axis{0, 0, 1};  ///< unit, from the tool's tip to its tail
  Vec3 across;         ///< unit, turns with the tool about its axis; zero: not known
  Vec3 extra_n;        ///< force of what the tool does, such as drilling; limited with the others
  std::uint32_t buttons = 0;
  bool drilling = false;  ///< the tool runs and may cut
  bool breached = false;  ///< in the last tick the drill came through (Drilling)
  bool away = false;      ///< what the tool lies in changes: it feels nothing, and begins anew afterwards
  double dt_s = 0.001;    ///< since the previous frame
  double period_s = 0;  ///< the loop's own; 0: dt_s. A longer dt_s is a stall, in which the device let its force decay
};

/// Buttons that the simulator itself gives a meaning; others are the drill's (Drilling).
namespace haptic_button {
constexpr std::uint32_t lifted = 1u << 31;  ///< the hand took the tool away and comes again wherever the pose is
}
namespace haptic_event {
constexpr std::uint32_t touch = 1, untouch = 2, motion = 4, popped = 8, left = 16, locked = 32, unlocked = 64,
                        breach = 128;
constexpr const char* names[] = {"touch", "untouch", "motion",   "popped",
                                 "left",  "locked",  "unlocked", "breach"};  ///< by bit
constexpr int count = int(sizeof names / sizeof *names);
}  // namespace haptic_event
/// The faults that make the force zero: until reset(), and those of a DevicePort that pass in the ticks that have them.
namespace haptic_fault {
constexpr std::uint32_t pose = 1, time_step = 2, force = 4, device_lost = 8, jump = 16, gap = 32;
constexpr std::uint32_t passing = jump | gap;
constexpr const char* names[] = {"pose", "time step", "force", "device lost", "jump", "gap"};  ///< by bit
constexpr int count = int(sizeof names / sizeof *names);
}  // namespace haptic_fault
/// Such as "pose, device lost".
std::string fault_names(std::uint32_t faults);

struct HapticState {
  Vec3 force_n;         ///< on the hand
  Vec3 torque_n_mm;     ///< on the hand, about the tip
  Vec3 proxy_mm;        ///< where the tool's tip is shown; never behind a surface that holds it
  Vec3 axis{0, 0, 1};   ///< the shown axis: the device's, except where surfaces or a lock keep the tool from turning
  Vec3 across;          ///< of the shown tool; zero where neither it nor the device knows
  Vec3 normal;          ///< of the surface that presses most; zero without contact
  int touched = 0;      ///< its shape; 0 without contact
  int face = 0;         ///< 1 front, 2 back, 0 without contact
  int inside = 0;       ///< the shape that the proxy's tip is in, of round tools the middle of their end; 0 for none
  int held_by = 0;      ///< count of the surfaces that press
  bool locked = false;  ///< whether the tool's orientation is locked (docs/haptics.md, Tools)
  std::uint32_t events = 0, faults = 0;
};

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
/// The force changes by at most max_force_rate_n_per_s times the loop's period a frame, however long the frame was.
/// After a stall it starts from what the device still holds (ForceHold).
///
/// The torque on the hand about the tip is that of the surfaces' forces where they press, and, where surfaces keep the
/// tool from turning with the device, that of a spring between the two orientations. It has limits as the force has,
/// and is 0 where the force is 0 for a fault.
///
/// While HapticInput::away is set the force falls to zero as fast as it may change. While the button
/// haptic_button::lifted is down there is neither contact nor force, and the tool is shown at the
/// device; then it starts again.
///
/// A round tool (Tool::round) is exactly round: the proxy holds the middle lines of its parts off all surfaces by their
/// radii (RoundBody). A ball alone turns with the device. Another round tool turns as far as surfaces let it, where its
/// tip may give way; it does not lock, and for a fast turn it takes some frames.
///
/// update() does not allocate, lock or throw and makes no system call; equal inputs give equal bits.
class Proxy {
 public:
  /// `contact` must outlive it.
  Proxy(const contact::ContactVolume& contact, const Feels& feels, const ForceParams& force,
        const ShaftParams& shaft = {}, const Tool& tool = {});

  /// A pose, axis or time step that is not finite, or a step that is not in (0, 1] s, is a fault: the force is exactly
  /// 0 from then on, until reset().
  const HapticState& update(const HapticInput& given);
  /// Latches a fault from outside, such as a lost device.
  void latch(std::uint32_t fault);
  /// Starts again: the next update places the proxy, and forces rise from 0.
  void reset();
  const HapticState& state() const { return state_; }
  /// Changes of the force that were smoothed so far.
  std::uint64_t eased() const { return ease_.count(); }
  /// Where each point of the tool is shown; null for a point.
  const ToolBody* tool_body() const { return body_ ? &*body_ : nullptr; }

 private:
  void begin(const HapticInput& in);
  void follow(Vec3 device_mm);
  bool meet(const contact::Contact& c, Vec3 device_mm, Vec3& goal_mm, int pass);
  static Vec3 straight_under(Vec3 from_mm, Vec3 normal, Vec3 device_mm);
  bool step_over(const contact::Contact& c, Vec3 device_mm, Vec3 goal_mm);
  void approach(const contact::Contact& c);
  Vec3 surface_force(Vec3 device_mm);
  void set_torque(const HapticInput& in, Vec3 before);
  Vec3 inside_force(const HapticInput& in);
  void hold_corner(Vec3 device_mm);
  Vec3 limited(Vec3 force, Vec3 sent, const HapticInput& in) const;
  void note_events(const HapticState& before);

  // The functions of proxy_tool.cpp: the same for a tool.
  struct Wall {
    contact::Plane plane;  // for the tip
    int point;
  };
  void begin_tool(const HapticInput& in);
  void follow_tool(const HapticInput& in);
  bool meet_tool(const ToolBody::Meeting& m, Vec3 device_mm, Vec3& goal_mm, Mat3& aim, int pass);
  int find_walls(const ToolBody::Meeting& m, Wall* walls) const;
  contact::Plane tip_plane(int point, Vec3 normal) const;
  void approach_tool(const ToolBody::Meeting& m);
  bool step_over_tool(Vec3 normal, bool straight, Vec3 device_mm, Vec3 goal_mm);
  void pop_into(const contact::Contact& contact);
  void hold_turn(Vec3 device_mm, Vec3& goal_mm, Mat3& aim);
  void open_behind();
  contact::TouchableFaces closed_faces() const;

  // The functions of proxy_lock.cpp.
  struct Loose {
    Mat3 frame;
    Vec3 way_mm;  // of the tip
  };
  bool should_lock(const ToolBody::Meeting& m, Vec3 turn);
  void try_unlock(Vec3 axis, Vec3 device_mm);
  bool holds_line(Vec3 device_mm) const;
  void follow_line(Vec3 device_mm);
  void note_drawn(Vec3 behind_mm);
  bool draws_out() const;
  void slide_out(Vec3 device_mm);
  Loose next_loose(const Mat3& frame);
  void work_loose();
  void slide_out_round(Vec3 device_mm);

  // The functions of proxy_round.cpp: the same for a round tool.
  void begin_round(const HapticInput& in);
  bool round_is_free(Vec3 centre_mm, Vec3 axis);
  bool round_is_busy(double share) const;
  void follow_round(const HapticInput& in);
  void turn_round(Vec3 axis);
  RoundBody::Touch move_round(Vec3 goal_mm);
  RoundBody::Touch close_to(Vec3 next_mm, RoundBody::Touch touch);
  HeldSurface held_of(const RoundBody::Touch& touch) const;
  bool meet_round(const RoundBody::Touch& touch, Vec3 device_mm, Vec3& goal_mm);

  static constexpr double max_turn_rad = 0.5;  // of a tool of many points, in a frame
  HeldSurface held(const contact::Contact& contact) const;

  const contact::ContactVolume& contact_;
  Feels feels_;
  ForceParams force_;
  contact::TouchableFaces faces_;
  double margin_mm_, step_mm_;
  bool stepped_;  // the walk

  HapticState state_;
  bool begun_ = false;
  ForceEase ease_;
  ForceSlew slew_;
  double stiffest_n_per_mm_ = 0;
  double since_s_ = 0;
  Vec3 device_mm_, velocity_, moved_from_mm_;
  HeldSurfaces surfaces_;
  SlidingFriction friction_;
  ShaftFriction shaft_;
  Vec3 pressed_n_mm_;  // torque of the surfaces of this frame

  Tool tool_;
  std::optional<ToolBody> body_;
  std::optional<RoundBody> round_;
  Vec3 centre_mm_;  // its
  contact::TouchableFaces open_{0, 0},
      crossed_{0, 0};  // faces that were popped through, and those of them found along the axis in this round
  WayOut way_out_;
  int slice_ = 0;  // the slice of the axis to be examined next
  Vec3 lock_normal_;
  double lock_dot_ = 0;
  HeldSurface line_held_;               // the wall of the lock
  int locked_for_ = 0, drawn_for_ = 0;  // frames
  int loosened_ = 0;                    // places that were tried, to work it loose
  struct Collided {                     // in this frame
    int point;
    Vec3 at_mm, normal;
    HeldSurface held;
  };
  Collided from_tip_, from_tail_;
  bool any_collided_ = false;
};

}  // namespace trephine::haptics
