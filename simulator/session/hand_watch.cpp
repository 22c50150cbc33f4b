// SPDX-License-Identifier: GPL-3.0-or-later
#include "session/hand_watch.h"

#include <utility>

namespace trephine::session {

HandWatch::HandWatch(const haptics::RecordingHeader& h, ShapeAt shape_at)
    : tools_(h.tools.size()),
      in_open_(h.in_open),
      drills_(h.drilling.drill),
      shape_at_(std::move(shape_at)),
      waits_(h.in_open) {}

void HandWatch::look(const haptics::ServoFrame& f) {
  const int given = haptics::belt_button::command(f.buttons);
  command_ = given == haptics::belt_button::command(buttons_) ? haptics::belt_command::none : given;
  if (tools_ > 0 || f.faults == 0) buttons_ = f.buttons;  // a drill without a belt takes it once the fault is over
  works_ = f.faults == 0;
  if (tools_ > 0) follow_belt(f);
  free_ = f.touched == 0 && f.inside == 0;
}

bool HandWatch::is_in_shape(const haptics::ServoFrame& f) const {
  if (!shape_at_) return f.touched != 0 || f.inside != 0;
  return shape_at_({f.tip_mm[0], f.tip_mm[1], f.tip_mm[2]}) != 0;
}

// As ToolBelt::update() and after().
void HandWatch::follow_belt(const haptics::ServoFrame& f) {
  namespace to = haptics::belt_command;
  if (command_ == to::resume) paused_ = false;
  if (command_ == to::pause && free_) paused_ = true;
  if (in_open_ && (paused_ || (f.buttons & haptics::haptic_button::lifted)))
    waits_ = true;
  else if (waits_)
    waits_ = shape_at_ && f.touched == 0 && is_in_shape(f);
  const auto asked = std::size_t(haptics::belt_button::tool(f.buttons));
  const bool idle = paused_ || waits_ || !begun_;
  begun_ = true;
  if (asked < tools_ && asked != tool_ && (!in_open_ || idle || (free_ && !is_in_shape(f)))) tool_ = asked;
  works_ = works_ && !paused_ && !waits_;
  const bool back = command_ == to::undo || command_ == to::reset;
  if (back && works_ && drills_ && !(f.buttons & haptics::belt_button::pedal)) waits_ = in_open_;
}

}  // namespace trephine::session
