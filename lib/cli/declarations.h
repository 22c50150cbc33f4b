// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "cli/command.h"

namespace trephine::cli {

/// What parsing, help, reference and completion share; for the sources of this room only.

constexpr const char* help_help = "Show this help and end.";
constexpr const char* version_help = "Show the version and end.";
constexpr const char* common_title = "Common";

/// The name of a command in pages and completion: "library build" becomes library-build.
std::string page_of(const Command& command);
/// The group of a command: "library" of "library build"; empty for a command of one word.
std::string group_of(const Command& command);
/// The flag of a name: max_deviation_mm becomes --max-deviation-mm.
std::string flag_of(const std::string& name);
/// The placeholder for an argument's value: FILE, FOLDER, PATH, TEXT, or its choices.
std::string placeholder_of(const Argument& argument);
/// The placeholder for a parameter's value: NUMBER, X,Y,Z, ..., "" for a flag.
std::string placeholder_of(const Parameter& parameter);
/// How a message names an argument: "--volume", or "CONFIG" of one that is given by its place.
std::string name_of(const Argument& argument);
/// Such as "--volume FILE" or "CONFIG"; of a choice that is given by its place the choices.
std::string usage_of(const Argument& argument);
/// Such as "--max-deviation-mm NUMBER" or "--[no-]check".
std::string usage_of(const Parameter& parameter);
/// What the group's page lists: every parameter, nested ones by their path ("shapes.NAME.clear_mm").
std::vector<std::pair<std::string, DeclaredParameter>> listed_of(const AnyParams& defaults);
/// The usage in parts that are not broken: "trephine contour", "--volume FILE", "[--mask FILE]", "[parameters]".
std::vector<std::string> usage_of(const Program& program, const Command& command);
/// The command's own groups and the common one.
std::vector<ParameterGroup> all_groups(const Command& command);
/// Throws Error 70 where a declaration is wrong.
void check_declarations(const Program& program);
/// Throws ErrorList where a path is not of the kind that its argument asks for.
void check_paths(const ParsedCommand& parsed);

}  // namespace trephine::cli
