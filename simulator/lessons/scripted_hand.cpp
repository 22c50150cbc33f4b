// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/scripted_hand.h"

#include <algorithm>
#include <cmath>

namespace trephine::lessons {
namespace {

constexpr double arrived_mm = 0.3,
                 arrive_at_most_s = 0.5;  // how near, or for how long, the hand follows to a path's end

constexpr double rests_after_s = 1;  // a hand that waits and feels nothing rests, without tremor: long waits are cheap
constexpr double give_up_s = 20;     // of a movement that is held up for so long

}  // namespace

ScriptedHand::ScriptedHand(const device::HandParams& params, std::vector<HandMove> moves)
    : params_(params), moves_(std::move(moves)) {
  for (const HandMove& m : moves_)
    if (!m.path_mm.empty()) {
      aim_mm_ = body_.position_mm = m.path_mm.front();
      break;
    }
  done_ = moves_.empty();
}

void ScriptedHand::begin_move() {
  ++move_;
  corner_ = 0;
  ticks_of_move_ = 0;
  waited_s_ = held_s_ = 0;
}

// Moves the aim. Returns whether the movement is done.
bool ScriptedHand::advance(double part_s) {
  const HandMove& m = moves_[move_];
  const double pull_n = norm(aim_mm_ - body_.position_mm) * params_.arm_stiffness_n_per_mm;
  if (corner_ < m.path_mm.size()) {
    if (m.feed_force_n > 0 && pull_n > m.feed_force_n) {
      held_s_ += part_s;
      return held_s_ > give_up_s;
    }
    held_s_ = 0;
    for (double left = part_s * m.speed_mm_per_s; left > 0 && corner_ < m.path_mm.size();) {
      const Vec3 way = m.path_mm[corner_] - aim_mm_;
      const double length = norm(way);
      if (length > left) {
        aim_mm_ += way * (left / length);
        break;
      }
      aim_mm_ = m.path_mm[corner_++];
      left -= length;
    }
    return false;
  }
  waited_s_ += part_s;
  if (waited_s_ < m.wait_s) return false;
  return m.on_time || norm(aim_mm_ - body_.position_mm) < arrived_mm || waited_s_ >= m.wait_s + arrive_at_most_s;
}

bool ScriptedHand::read(double dt_s, device::DeviceReading& out) {
  bool over = false;
  for (double left = std::clamp(dt_s, 0.0, 10.0); left > 0;) {
    const double part = std::min(left, 0.001);
    left -= part;
    time_s_ += part;
    // A command needs a tick, and one without it before the next.
    if (!over && !done_) over = advance(part) && ticks_of_move_ >= 2;
    if (waited_s_ > rests_after_s && body_.force_n == Vec3{}) {
      body_.velocity = {};
      continue;
    }
    Vec3 to = aim_mm_;
    device::add_tremor(params_, time_s_, to);
    body_.pull(params_, hold_, to, part);
  }
  if (over) {
    begin_move();
    if (move_ >= moves_.size()) done_ = true;
  }
  const HandMove& m = moves_[std::min(move_, moves_.size() - 1)];
  out = {};
  out.tip_mm = body_.position_mm;
  out.axis = m.axis;
  out.buttons = (m.pedal ? haptics::belt_button::pedal : 0) | std::uint32_t(m.tool) << haptics::belt_button::tool_shift;
  if (ticks_of_move_++ == 0 && !done_) out.buttons |= std::uint32_t(m.command) << haptics::belt_button::command_shift;
  return is_finite(body_.position_mm) && !m.lost;
}

}  // namespace trephine::lessons
