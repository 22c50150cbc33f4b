// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "cli/command.h"

namespace trephine {

/// The simulator's commands, one a file in this folder.
Command check_command();
Command servo_command();
Command replay_command();

}  // namespace trephine
