// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "cli/command.h"

namespace trephine::commands {

/// --settings, a file of declared parameters, and --write-settings.
std::vector<cli::Argument> settings_arguments();

/// The command line with the values of --settings where it gives no other: a JSON object whose keys are the names of
/// the command's parameters. Throws Error 66; 65 naming the key where it is no parameter of the command, comes twice,
/// or has a value that is not allowed; 64 (65 with --settings)
/// where values contradict each other.
cli::ParsedCommand with_settings(const cli::ParsedCommand& parsed);
/// Where --write-settings is given, writes the effective values to that file, which --settings reads. Throws Error 73
/// and 74.
void write_settings(const cli::ParsedCommand& parsed);

}  // namespace trephine::commands
