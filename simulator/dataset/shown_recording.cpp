// SPDX-License-Identifier: GPL-3.0-or-later
#include "dataset/shown_recording.h"

namespace trephine::dataset {

ShownRecording::ShownRecording(session::Playback& playback, render::Stage& stage)
    : playback_(playback),
      stage_(stage),
      dust_(scene::dust_watch_of(playback)),
      target_(session::target_of(playback.header(), *playback.patient())) {}

void ShownRecording::go_to(double time_s) {
  playback_.go_to(time_s);
  if (playback_.tool_name() != tool_) {
    tool_ = playback_.tool_name();
    stage_.set_tool(playback_.tool());
  }
  stage_.follow(playback_.marks());
  std::size_t incisions = 0;
  for (const session::IncisionMark& mark : playback_.incisions()) incisions += mark.time_s <= playback_.time_s();
  stage_.show_incisions(playback_.incisions(), incisions);
  if (stage_.view().dust) dust_.go_to(playback_.frames(), playback_.frame_number() + 1, playback_.recording().second);
  stage_.show_dust(dust_.dust());
  stage_.state.moving = scene::moving_of(target_.get(), playback_.frame().time_s);
  stage_.show_frame(playback_.frame(), playback_.held_second(), playback_.second_frame());
}

}  // namespace trephine::dataset
