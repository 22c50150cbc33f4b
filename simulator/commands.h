// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "cli/command.h"

namespace trephine {

/// The simulator's commands, one a file in this folder.
Command check_command();

}  // namespace trephine
