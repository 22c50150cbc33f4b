// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "cli/command.h"

namespace trephine {

/// The commands of trephine-sim. Each has its own source in this folder; main.cpp lists them.
Command check_command();
Command servo_command();
Command replay_command();
Command lesson_command();
Command score_command();
Command fluoro_command();
Command exercise_command();
Command calibrate_command();
/// Not in a build with TREPHINE_HEADLESS.
Command render_command();
Command play_command();

}  // namespace trephine
