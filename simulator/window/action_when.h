// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "window/actions.h"

namespace trephine::window {

/// When an action can be done: each is empty where it can, and else says why not.
texts::Answer without_recording(const Player& p);  ///< while a hand is at work, in a lesson once it has begun
texts::Answer outside_lesson(const Player& p);
texts::Answer of_lesson(const Player& p);  ///< in a lesson that has begun
texts::Answer with_question(const Player& player);
texts::Answer of_arm(const Player& p);       ///< in a lesson with a C-arm, and a case with a CT
texts::Answer with_drill(const Player& p);   ///< where something can be cut
texts::Answer with_burr(const Player& p);    ///< where a tool that rotates is in hand, and may be changed
texts::Answer with_marker(const Player& p);  ///< where something can be drawn
texts::Answer with_volume(const Player& p);  ///< outside of a lesson, where rays can show a volume of HU
texts::Answer with_rays(const Player& p);    ///< and where they do

}  // namespace trephine::window
