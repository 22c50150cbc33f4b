// SPDX-License-Identifier: GPL-3.0-or-later
// The tools that a hand may hold. Whoever adds one adds an entry to all_tool_kinds(), and a row to the table of
// docs/reference/hand-tools.md; nothing else knows a tool by its name.
#include "base/error.h"
#include "haptics/tool.h"

namespace trephine::haptics {

ToolKind& ToolKind::shaped(ToolParams::Tip its_tip, double diameter, double length, double spacing) {
  tip = its_tip;
  diameter_mm = diameter;
  length_mm = length;
  spacing_mm = spacing;
  return *this;
}

ToolKind& ToolKind::exactly_round() {
  exact = true;
  return *this;
}

ToolKind& ToolKind::ball_alone() {
  exact = true;
  has_neck = false;
  return *this;
}

ToolKind& ToolKind::of_a_file() {
  from_file = true;
  return *this;
}

ToolKind& ToolKind::cuts_with(Cut what) {
  cut = what;
  return *this;
}

ToolKind& ToolKind::rotating(Cut what, int edges, double cutting) {
  cut = what;
  flutes = edges;
  cutting_mm = cutting;
  return *this;
}

ToolKind& ToolKind::sizes(std::vector<double> usual_mm) {
  sizes_mm = std::move(usual_mm);
  return *this;
}

ToolKind& ToolKind::draws() {
  marks = true;
  return *this;
}

ToolKind& ToolKind::suction() {
  takes_up = true;
  return *this;
}

ToolKind& ToolKind::saline() {
  rinses = true;
  return *this;
}

ToolKind& ToolKind::looks(Look how) {
  look = how;
  return *this;
}

const std::vector<ToolKind>& all_tool_kinds() {
  using Tip = ToolParams::Tip;
  using Cut = ToolKind::Cut;
  using Look = ToolKind::Look;
  using Kind = ToolKind;
  // The measures: diameter, length and spacing of the points, in mm.
  static const std::vector<ToolKind> all = {
      Kind("point", "Spitze", "the tip alone"),
      Kind("needle", "Nadel", "of 18 gauge, for the spine").shaped(Tip::cone, 1.27, 90, 2).looks(Look::syringe),
      Kind("catheter", "Katheter", "for a ventricle").shaped(Tip::round, 2.5, 100, 2).looks(Look::tube),
      Kind("burr", "Bohrer", "a ball on a thinner neck")
          .shaped(Tip::ball, 5, 30, 1.2)
          .rotating(Cut::ball, 8)
          .sizes({2, 3, 4, 5, 6, 7}),
      Kind("ball", "Kugel", "a burr's ball alone, exactly round")
          .shaped(Tip::ball, 5, 5, 1.2)
          .ball_alone()
          .rotating(Cut::ball, 8)
          .sizes({2, 3, 4, 5, 6, 7}),
      Kind("round_burr", "Rundbohrer", "a ball on a thinner neck, exactly round")
          .shaped(Tip::ball, 5, 30, 1.2)
          .exactly_round()
          .rotating(Cut::ball, 8)
          .sizes({2, 3, 4, 5, 6, 7}),
      Kind("diamond", "Diamant", "a ball of fine grit on a thinner neck, exactly round")
          .shaped(Tip::ball, 4, 30, 1.2)
          .exactly_round()
          .rotating(Cut::ball, 40)
          .sizes({2, 3, 4, 5, 6}),
      Kind("matchstick", "Matchstick", "a slim cylinder with a round end that cuts at its side, exactly round")
          .shaped(Tip::round, 3, 30, 1.2)
          .exactly_round()
          .rotating(Cut::rounded, 6, 8)
          .sizes({2, 3, 4}),
      Kind("cylinder", "Walze", "a cylinder with a flat end, thicker than a craniotome")
          .shaped(Tip::flat, 4, 24, 1.2)
          .rotating(Cut::cylinder, 8, 6)
          .sizes({3, 4, 5, 6}),
      Kind("rod", "Stab", "a rod with round ends, exactly round").shaped(Tip::round, 2.5, 30, 2).exactly_round(),
      Kind("craniotome", "Kraniotom", "a cylinder with a flat end")
          .shaped(Tip::flat, 2.3, 20, 1.2)
          .rotating(Cut::cylinder, 4, 8)
          .sizes({1.5, 2.3, 3}),
      Kind("jamshidi", "Jamshidi", "a needle of 11 gauge, for bone")
          .shaped(Tip::cone, 3.05, 100, 2)
          .looks(Look::cross_handle),
      Kind("screw", "Schraube", "a pedicle screw on its driver").shaped(Tip::cone, 5.5, 45, 3).looks(Look::screw),
      Kind("points", "Punkte", "points of your own, from a file").of_a_file(),
      Kind("marker", "Stift", "a pen for the skin, felt at its tip alone").draws().looks(Look::pen),
      Kind("suction", "Sauger", "a tube that takes up blood and saline, exactly round")
          .shaped(Tip::round, 3, 60, 2)
          .exactly_round()
          .suction(),
      Kind("irrigation", "Spülung", "a syringe of saline, for blood and bone dust")
          .shaped(Tip::round, 2, 40, 2)
          .saline()
          .looks(Look::syringe),
      Kind("scalpel", "Skalpell", "a blade that opens what is incised, felt at its tip alone")
          .cuts_with(Cut::incision)
          .looks(Look::blade),
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

}  // namespace trephine::haptics
