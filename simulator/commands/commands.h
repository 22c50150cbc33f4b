// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "cli/command.h"

namespace trephine::commands {

/// The commands of trephine-sim. Each has its own source in this folder; main.cpp lists them.
cli::Command check_command();
cli::Command servo_command();
cli::Command replay_command();
cli::Command explain_command();
cli::Command lesson_command();
cli::Command lessons_command();
cli::Command score_command();
cli::Command sign_command();
cli::Command fluoro_command();
cli::Command exercise_command();
cli::Command calibrate_command();
cli::Command register_command();
cli::Command study_command();
cli::Command group_command();
cli::Command export_recording_command();
cli::Command compare_command();
/// Not in a build with TREPHINE_HEADLESS.
cli::Command render_command();
cli::Command play_command();

}  // namespace trephine::commands
