// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "cli/command.h"

namespace trephine {

/// What parsing, help, reference and completion share; for their sources only.

constexpr const char* help_help = "Show this help and end.";
constexpr const char* version_help = "Show the version and end.";
constexpr const char* common_title = "Common";

/// "library build" -> library-build: what pages and completion call a command.
std::string page_of(const Command& command);
/// "library" of "library build"; empty for a command of one word.
std::string group_of(const Command& command);
/// max_deviation_mm -> --max-deviation-mm
std::string flag_of(const std::string& name);
/// What stands for an argument's value: FILE, FOLDER, PATH, TEXT, or its choices.
std::string placeholder_of(const Argument& argument);
/// What stands for a parameter's value: NUMBER, X,Y,Z, ..., "" for a flag.
std::string placeholder_of(const Parameter& parameter);
/// "--volume FILE" or "CONFIG"
std::string usage_of(const Argument& argument);
/// "--max-deviation-mm NUMBER" or "--[no-]check"
std::string usage_of(const Parameter& parameter);
/// What the group's page lists: every parameter, those within others by their place ("shapes.NAME.clear_mm").
std::vector<std::pair<std::string, DeclaredParameter>> listed_of(const AnyParams& defaults);
/// "trephine contour", "--volume FILE", "[--mask FILE]", "[parameters]": parts that stay on one line each.
std::vector<std::string> usage_of(const Program& program, const Command& command);
/// The command's groups and the common one.
std::vector<ParameterGroup> all_groups(const Command& command);
/// Throws 70 where a declaration is at fault.
void check_declarations(const Program& program);
/// Throws ErrorList where a path is not what its argument's kind asks for.
void check_paths(const ParsedCommand& parsed);

}  // namespace trephine
