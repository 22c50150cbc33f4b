// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "haptics/frame.h"

namespace trephine::lessons {

/// SHA-256 of what the hand did: poses, buttons, steps, and where the device was lost. Header and answers are no part
/// of it, so a recording whose participant, task or forces were edited keeps it.
std::string motion_digest(const std::vector<haptics::ServoFrame>& frames);

}  // namespace trephine::lessons
