// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <vector>

#include "cli/command.h"
#include "session/second_hand.h"

namespace trephine::commands {

/// The flags of a second hand: those of the first one's device, workspace, limits and tool, each with `second_` before
/// its name.
std::vector<cli::Argument> second_arguments();
std::vector<cli::ParameterGroup> second_groups();
/// Nothing where no second device is given. Throws Error 64 for its flags without it, for a tool that the second hand
/// does not hold, and where both hands would hold one device.
std::optional<session::SecondOptions> second_options_of(const cli::ParsedCommand& parsed,
                                                        const device::DeviceChoice& first);

}  // namespace trephine::commands
