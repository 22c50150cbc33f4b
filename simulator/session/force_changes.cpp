// SPDX-License-Identifier: GPL-3.0-or-later
#include "session/force_changes.h"

#include <algorithm>

#include "haptics/drilling.h"

namespace trephine::session {
namespace {

constexpr double event_s = 0.02, told_n_per_ms = 0.1;

}  // namespace

ForceChanges force_changes(const std::vector<haptics::ServoFrame>& frames, bool drilling) {
  ForceChanges out;
  double since_event_s = 2 * event_s;
  for (std::size_t n = 1; n < frames.size(); ++n) {
    const haptics::ServoFrame &before = frames[n - 1], &f = frames[n];
    since_event_s =
        f.events & (haptics::haptic_event::popped | haptics::haptic_event::breach) ? 0 : since_event_s + f.dt_s;
    if (drilling && (!(f.buttons & haptics::Drilling::pedal) || (f.touched == 0 && before.touched == 0))) continue;
    const Vec3 is{f.force_n[0], f.force_n[1], f.force_n[2]},
        was{before.force_n[0], before.force_n[1], before.force_n[2]};
    const double change = norm(is - was) / (1000 * f.dt_s);
    ++out.ticks;
    for (std::size_t k = 0; k < out.above.size(); ++k) out.above[k] += change > ForceChanges::limits_n_per_ms[k];
    out.named += change > told_n_per_ms && since_event_s <= event_s;
    out.max_n_per_ms = std::max(out.max_n_per_ms, change);
    out.turns += f.touched != 0 && before.touched != 0 && f.touched != before.touched;
  }
  return out;
}

}  // namespace trephine::session
