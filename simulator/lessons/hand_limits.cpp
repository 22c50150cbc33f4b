// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/hand_limits.h"

#include <fmt/format.h>

#include <utility>

#include "base/error.h"

namespace trephine::lessons {

void HandLimits::refuse(const haptics::ServoFrame& f, const std::string& what) const {
  throw Error(ExitCode::bad_input, "", "frames",
              fmt::format("{}tick {}, {:.2f} s: {}", whose_, f.tick, f.time_s, what));
}

void HandLimits::look(const haptics::ServoFrame& f, const haptics::ToolBelt& belt) {
  const Vec3 tip{f.tip_mm[0], f.tip_mm[1], f.tip_mm[2]};
  if ((f.faults & haptics::haptic_fault::jump) && !belt.paused())
    refuse(f, fmt::format("the device jumped, and no hand is faster than {:g} m/s", max_hand_m_per_s));
  if (f.faults & haptics::haptic_fault::gap) {  // nothing is known of the hand's way, and the device says nothing new
    if (!moments_.empty() && !(moments_.back().tip_mm == tip)) refuse(f, "the tool moves while its device is silent");
    moments_.assign(1, {f.time_s, tip});
    was_silent_ = true;
    return;
  }
  if (std::exchange(was_silent_, false)) moments_.clear();
  if (belt.paused() || (f.buttons & haptics::haptic_button::lifted)) {
    away_ = true;
    moments_.clear();
    within_.clear();
    return;
  }
  const bool other = belt.in_hand() != tool_;
  // A belt that waits for a pose outside answers with nothing, and nothing can be judged of it.
  const bool felt = f.inside != 0 || f.touched != 0;
  if ((away_ || other) && felt && contact_.shape_at(tip) != 0)
    refuse(f, tool_ < 0 ? "it begins inside of the patient"
              : other   ? "the tool is changed inside of the patient"
                        : "the tool comes again inside of the patient");
  if (other && !away_ && inside_ != 0) refuse(f, "the tool is changed inside of the patient");
  if (felt || contact_.shape_at(tip) == 0) {
    away_ = false;
    tool_ = belt.in_hand();
  }
  inside_ = f.inside;
  look_at_speed(f);
  look_at_pace(f);
}

// A recording whose times were shrunk is a hand that does everything sooner than hands can.
void HandLimits::look_at_pace(const haptics::ServoFrame& f) {
  if (f.inside == 0) return within_.clear();
  const Vec3 at{f.proxy_mm[0], f.proxy_mm[1], f.proxy_mm[2]};
  within_.push_back({f.time_s, at});
  while (within_.size() > 2 && within_[1].time_s <= f.time_s - forward_window_s + 1e-9) within_.pop_front();
  const double since_s = f.time_s - within_.front().time_s;
  if (since_s < forward_window_s - 1e-9) return;
  const double forward = -dot(at - within_.front().tip_mm, Vec3{f.axis[0], f.axis[1], f.axis[2]}) / since_s;
  if (forward > 1000 * max_forward_m_per_s)
    refuse(f, fmt::format("the tool goes into the patient with {:.1f} m/s, and no hand's with more than {:g}",
                          forward / 1000, max_forward_m_per_s));
}

void HandLimits::look_at_speed(const haptics::ServoFrame& f) {
  const Vec3 tip{f.tip_mm[0], f.tip_mm[1], f.tip_mm[2]};
  moments_.push_back({f.time_s, tip});
  while (moments_.size() > 3 && moments_[1].time_s <= f.time_s - 2 * hand_window_s) moments_.pop_front();
  std::size_t middle = moments_.size() - 1;
  while (middle > 0 && moments_[middle].time_s > f.time_s - hand_window_s + 1e-9) --middle;
  const double late_s = f.time_s - moments_[middle].time_s;
  if (late_s < hand_window_s - 1e-9) return;
  const Vec3 late = (tip - moments_[middle].tip_mm) / late_s;  // mm/s
  if (norm(late) > 1000 * max_hand_m_per_s)
    refuse(f, fmt::format("the tool moves with {:.1f} m/s, and no hand with more than {:g}", norm(late) / 1000,
                          max_hand_m_per_s));
  const double early_s = moments_[middle].time_s - moments_[0].time_s;
  if (early_s < hand_window_s - 1e-9) return;
  const Vec3 early = (moments_[middle].tip_mm - moments_[0].tip_mm) / early_s;
  const double rate = norm(late - early) / (0.5 * (late_s + early_s)) / 1000;
  if (rate > max_hand_m_per_s2)
    refuse(f, fmt::format("the tool is moved with {:.0f} m/s2, and by no hand with more than {:g}", rate,
                          max_hand_m_per_s2));
}

}  // namespace trephine::lessons
