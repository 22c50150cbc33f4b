// SPDX-License-Identifier: GPL-3.0-or-later
#include "session/hand_watch.h"

#include <utility>

namespace trephine::session {

HandWatch::HandWatch(const haptics::RecordingHeader& h, ShapeAt shape_at)
    : tools_(h.tools.size()), drills_(h.drilling.drill), shape_at_(std::move(shape_at)), rules_(h.tools.size()) {}

HandWatch::HandWatch(const haptics::RecordedSecondHand& held, ShapeAt shape_at)
    : tools_(held.switch_only ? 0 : 1), drills_(false), shape_at_(std::move(shape_at)), rules_(tools_) {}

bool HandWatch::takes_back() const {
  if (tools_ > 0) return rules_.takes_back();
  return drills_ && works_ && haptics::belt_command::takes_back(command_) && !(buttons_ & haptics::belt_button::pedal);
}

void HandWatch::look(const haptics::ServoFrame& f, const HandWatch& first) {
  rules_.obey(first.rules_.paused(), first.takes_back());
  look(f);
}

void HandWatch::look(const haptics::ServoFrame& f) {
  command_ = haptics::belt_command::new_of(f.buttons, buttons_);
  if (tools_ > 0 || f.faults == 0) buttons_ = f.buttons;  // a drill without a belt takes it once the fault is over
  works_ = f.faults == 0;
  if (tools_ > 0) follow_belt(f);
  free_ = f.touched == 0 && f.inside == 0;
}

bool HandWatch::is_in_shape(const haptics::ServoFrame& f) const {
  if (!shape_at_) return f.touched != 0 || f.inside != 0;
  return shape_at_({f.tip_mm[0], f.tip_mm[1], f.tip_mm[2]}) != 0;
}

void HandWatch::follow_belt(const haptics::ServoFrame& f) {
  const auto still_waits = [&] { return shape_at_ && f.touched == 0 && is_in_shape(f); };
  rules_.begin(f.buttons, free_, still_waits, [&] { return is_in_shape(f); });
  works_ = works_ && !rules_.idle();
  rules_.end(f.buttons, f.faults == 0, drills_);
}

std::vector<std::size_t> tools_in_hand(const haptics::Recording& r) {
  HandWatch hand(r.header);
  std::vector<std::size_t> tools;
  tools.reserve(r.frames.size());
  for (const haptics::ServoFrame& f : r.frames) {
    hand.look(f);
    tools.push_back(hand.tool());
  }
  return tools;
}

}  // namespace trephine::session
