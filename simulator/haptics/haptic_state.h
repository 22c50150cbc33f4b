// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <string>

#include "base/vec3.h"

namespace trephine::haptics {

/// The pose of a device in one frame.
struct HapticInput {
  Vec3 tip_mm;
  Vec3 axis{0, 0, 1};  ///< unit, from the tool's tip to its tail
  Vec3 across;         ///< unit, turns with the tool about its axis; zero: not known
  Vec3 extra_n;        ///< force of what the tool does, such as drilling; limited with the others
  std::uint32_t buttons = 0;
  bool drilling = false;         ///< the tool runs and may cut
  bool breached = false;         ///< in the last tick the drill came free of bone that it went through (Drilling)
  std::uint64_t giving_way = 0;  ///< shapes that let go of a drill (drill::LettingGo), bit n for shape n
  double held_ratio = 1;         ///< and what is left of their stiffness
  bool away = false;             ///< what the tool lies in changes: it feels nothing, and begins anew afterwards
  double dt_s = 0.001;           ///< since the previous frame
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
  Vec3 force_n;           ///< on the hand
  Vec3 torque_n_mm;       ///< on the hand, about the tip
  Vec3 proxy_mm;          ///< where the tool's tip is shown; never behind a surface that holds it
  Vec3 axis{0, 0, 1};     ///< the shown axis: the device's, except where surfaces or a lock keep the tool from turning
  Vec3 across;            ///< of the shown tool; zero where neither it nor the device knows
  Vec3 normal;            ///< of the surface that presses most; zero without contact
  int touched = 0;        ///< its shape; 0 without contact
  int face = 0;           ///< 1 front, 2 back, 0 without contact
  int inside = 0;         ///< the shape that the proxy's tip is in, of round tools the middle of their end; 0 for none
  int held_by = 0;        ///< count of the surfaces that press
  int held_at = 0;        ///< at how many places surfaces hold the tool
  float held_mm[3][3]{};  ///< these, as a recording holds them: what a drill cuts is followed from it
  bool locked = false;    ///< whether the tool's orientation is locked (docs/reference/hand-tools.md, Tools)
  std::uint32_t events = 0, faults = 0;
};

}  // namespace trephine::haptics
