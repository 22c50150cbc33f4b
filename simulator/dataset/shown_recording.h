// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>
#include <string>

#include "render/stage.h"
#include "scene/bone_dust.h"
#include "session/moving_target.h"
#include "session/playback.h"

namespace trephine::dataset {

/// A recording on a stage: what is seen of it at any of its times. Both must outlive it.
class ShownRecording {
 public:
  ShownRecording(session::Playback& playback, render::Stage& stage);
  /// Tool, bone, incisions and dust as they were then.
  void go_to(double time_s);

 private:
  session::Playback& playback_;
  render::Stage& stage_;
  scene::DustWatch dust_;
  std::shared_ptr<const session::MovingTarget> target_;
  std::string tool_;  ///< in hand in the picture before
};

}  // namespace trephine::dataset
