// SPDX-License-Identifier: GPL-3.0-or-later
// The tools that a hand may hold. Whoever adds one adds a line here, and a row to the table of docs/haptics.md.
#include "base/error.h"
#include "haptics/tool.h"

namespace trephine {

const std::vector<ToolKind>& all_tool_kinds() {
  using Tip = ToolParams::Tip;
  static const std::vector<ToolKind> all = {
      {"point", "the tip alone"},
      {"needle", "of 18 gauge, for the spine", Tip::cone, 1.27, 90, 2},
      {"catheter", "for a ventricle", Tip::round, 2.5, 100, 2},
      {"burr", "a ball on a thinner neck", Tip::ball, 5, 30, 1.2},
      {"ball", "a burr's ball alone, exactly round", Tip::ball, 5, 5, 1.2, true},
      {"round_burr", "a ball on a thinner neck, exactly round", Tip::ball, 5, 30, 1.2, true},
      {"rod", "a rod with round ends, exactly round", Tip::round, 2.5, 30, 2, true},
      {"craniotome", "a cylinder with a flat end", Tip::flat, 2.3, 20, 1.2},
      {"jamshidi", "a needle of 11 gauge, for bone", Tip::cone, 3.05, 100, 2},
      {"points", "points of your own, from a file", Tip::own, 0, 0, 0, false, true},
      {"marker", "a pen for the skin, felt at its tip alone"},
      {"scalpel", "a blade that opens what is incised, felt at its tip alone"},
  };
  return all;
}

const ToolKind& tool_kind(const std::string& name) {
  for (const ToolKind& kind : all_tool_kinds())
    if (name == kind.name) return kind;
  throw Error(ExitCode::bad_config, "", "tool", name + ": there is no such tool");
}

std::vector<std::string> tool_names() {
  std::vector<std::string> names;
  for (const ToolKind& kind : all_tool_kinds()) names.push_back(kind.name);
  return names;
}

const char* tool_help() {
  static const std::string help = [] {
    std::string text;
    for (const ToolKind& kind : all_tool_kinds())
      text += (text.empty() ? "What the hand holds: " : ", ") + std::string(kind.name) + " (" + kind.help + ")";
    return text + ".";
  }();
  return help.c_str();
}

}  // namespace trephine
