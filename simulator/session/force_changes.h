// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "haptics/frame.h"

namespace trephine::session {

/// How much the force changes from tick to tick, by the milliseconds between: a histogram of what a hand feels as
/// jumps.
struct ForceChanges {
  static constexpr std::array<double, 5> limits_n_per_ms{0.02, 0.05, 0.1, 0.2, 0.5};
  std::uint64_t ticks = 0;
  std::array<std::uint64_t, limits_n_per_ms.size()> above{};  ///< how many changes were larger than each limit
  std::uint64_t named = 0;  ///< of those above 0.1, in the 20 ms of an event that has a name: a pop or a breach
  double max_n_per_ms = 0;
  std::uint64_t turns = 0;  ///< how often the touched shape changed from one to another on successive ticks
};
/// Of all ticks, or of those in which the pedal was down and something was touched.
ForceChanges force_changes(const std::vector<haptics::ServoFrame>& frames, bool drilling);

}  // namespace trephine::session
