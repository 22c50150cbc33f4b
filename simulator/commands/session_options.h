// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "cli/command.h"
#include "session/session.h"

namespace trephine::commands {

/// What the commands that hold a tool in a case have in common. `own` is the kind of device where none is given; where
/// it is none of device_types(), it is a further choice.
std::vector<cli::Argument> session_arguments(const std::string& own);
/// The same of a command that only measures with the device: nothing is recorded.
std::vector<cli::Argument> measuring_arguments();
std::vector<cli::ParameterGroup> session_groups();
/// What a device is told of a case that is touched alone: nothing is drilled, and no window shows it. `say` gets its
/// notes in English. It refers to the patient.
device::DeviceScene touched_scene(const session::Patient& patient, bool in_real_time,
                                  std::function<void(const std::string&)> say);
/// --before: recordings that came before the one that is run again. parsed.all("before") gives their paths.
cli::Argument before_argument();
/// Without the duration.
session::SessionOptions session_options_of(const cli::ParsedCommand& parsed);
/// "a, b, or c": the kinds of devices as they say it themselves.
std::string devices_text();

}  // namespace trephine::commands
