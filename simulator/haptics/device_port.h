// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <atomic>
#include <cstdint>
#include <optional>

#include "base/params.h"
#include "haptics/feel.h"
#include "haptics/free_feel.h"
#include "haptics/hand_motion.h"
#include "haptics/haptic_state.h"
#include "haptics/passivity.h"

namespace trephine::haptics {

struct PortParams {
  double jump_m_per_s = max_hand_m_per_s, let_in_s = 0.1, device_delay_ms = 0, device_own_damping_n_s_per_mm = 0;
  bool allow_undamped = false;
  /// As recordings without these were felt.
  static PortParams none() {
    PortParams p;
    p.jump_m_per_s = 0;
    return p;
  }
  template <class V>
  static void describe(V& v) {
    using P = PortParams;
    v.number(&P::jump_m_per_s, "jump_m_per_s", Range{0, 1000},
             "A device that moves faster has jumped, as no hand does: the force is zero, and the tool begins anew "
             "where it then is; 0: it may jump.");
    v.number(&P::let_in_s, "let_in_s", Range{0, 10},
             "Time over which the force comes back after a jump, or after a gap in which the device gave no pose.");
    v.number(&P::device_delay_ms, "device_delay_ms", Range{0, 20},
             "The device's delay, from a motion of the hand to the force that answers it. With a delay every stiffness "
             "is lowered by one ratio to what the device's own damping makes stable; 0: forces are as without a "
             "delay.");
    v.number(&P::device_own_damping_n_s_per_mm, "device_own_damping_n_s_per_mm", Range{0, 0.1},
             "The device's own damping, which a delay is measured against; 0: what the device reports.");
    v.flag(&P::allow_undamped, "allow_undamped",
           "Start with a delay where the device's damping is not known. No wall is stable there: the force is kept so "
           "small that the hand is given no energy, and a wall yields to a lasting press.");
  }
  /// Whether the delay bounds what can be felt (delayed_walls.h). Otherwise, with a delay, Passivity lowers the force.
  bool bounds_walls() const { return device_delay_ms > 0 && device_own_damping_n_s_per_mm > 0; }
};

/// What lies between a device and what is felt: jumps that no hand does, gaps in which the device gave no pose, and the
/// energy that a delay would give to the hand. A jump or a gap is a fault that passes: it is named in the frames that
/// have it (haptic_fault::passing), in which the force is zero; then the force comes back.
///
/// - A jump is a motion faster than jump_m_per_s. The speed is that since the pose last changed, taken over 5 to 10 ms:
///   poses come late by some ms, and not every device gives one in each tick. The tool counts as lifted in that tick.
/// - While the device is silent nothing drills, and no command is taken. Afterwards the tool goes on from where it was;
///   where the device has moved meanwhile by more than it does in 10 ms at jump_m_per_s, the tool is placed anew.
///
/// With PortParams::none() every input and answer is passed on as it is. It neither allocates nor locks; equal inputs
/// give equal bits.
class DevicePort {
 public:
  /// `free`: what is added to the input's extra_n. Throws as FreeFeel does.
  DevicePort(const PortParams& params, const ForceParams& force, const FreeParams& free = {});
  /// Before the proxy. `silent`: the device gave no pose for too long.
  void before(HapticInput& in, bool silent);
  /// The same for a recorded tick with these faults.
  void again(HapticInput& in, std::uint32_t faults);
  /// After it: what the hand is to feel.
  const HapticState& after(const HapticInput& in, const HapticState& state);

  /// Other threads may ask.
  std::uint64_t jumps() const { return jumps_.load(std::memory_order_relaxed); }
  std::uint64_t gaps() const { return gaps_.load(std::memory_order_relaxed); }

 private:
  void look(HapticInput& in);

  const PortParams params_;
  const ForceParams force_;
  std::optional<Passivity> passivity_;
  std::optional<FreeFeel> free_;
  HapticState state_;
  Vec3 last_mm_, sent_n_;
  bool known_ = false, silent_ = false;
  double since_s_ = 0, back_s_;  // since the pose changed; since the force comes back
  std::uint32_t passing_ = 0;
  std::atomic<std::uint64_t> jumps_{0}, gaps_{0};
};

}  // namespace trephine::haptics
