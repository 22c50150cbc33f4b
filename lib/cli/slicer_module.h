// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "cli/command.h"

namespace trephine::cli {

/// A command as a module of 3D Slicer: an executable that prints its description for `--xml` and otherwise takes its
/// parameters as flags and words (the Slicer execution model: slicer.readthedocs.io, developer guide, Module Overview,
/// Command Line Interface; github.com/Slicer/SlicerExecutionModel). `PROGRAM slicer-module COMMAND` is one; the
/// launchers in lib/trephine/slicer-modules call it.

/// The description in XML, from the command's declaration: its arguments, its parameters by group, and those of every
/// command among the advanced ones. A flag that is on by default becomes its opposite, because a module cannot turn a
/// flag off.
std::string slicer_module_xml(const Program& program, const Command& command);

/// The words for the command of those that Slicer gives. It gives every parameter, also those that nobody changed; so
/// what is empty, unset or at its default is left out, and what Slicer asks for itself.
std::vector<std::string> words_of_slicer(const Command& command, const std::vector<std::string>& words);

}  // namespace trephine::cli
