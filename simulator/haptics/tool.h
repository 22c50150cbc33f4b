// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "base/params.h"
#include "touch/frames.h"

namespace trephine::haptics {

/// The values of --tool and their help, from all_tool_kinds().
std::vector<std::string> tool_names();
const char* tool_help();

/// What the hand holds, as points on its outside [Rizzi, chapter 5]. 0 and `own` stand for the values of the tool's
/// kind, which own_tool() fills in.
struct ToolParams {
  enum class Tip { own, flat, round, cone, ball };
  /// both: the first point that collides counted from the tip and the first counted from the tail, with their normals
  /// averaged (the refinement of [Rizzi, chapter 5], which alone can lock); else one of the two.
  enum class Search { both, tip_to_tail, tail_to_tip };
  std::string tool = "point";  ///< the name of a ToolKind
  Tip tool_tip = Tip::own;
  double tool_diameter_mm = 0, tool_length_mm = 0, tool_spacing_mm = 0;
  Search tool_search = Search::both;
  double lock_distance_mm = 3;
  std::string tool_points, tool_points_sha256;
  template <class V>
  static void describe(V& v) {
    using P = ToolParams;
    v.word(&P::tool, "tool", tool_names(), tool_help());
    v.choice(&P::tool_tip, "tool_tip",
             {{"own", Tip::own}, {"flat", Tip::flat}, {"round", Tip::round}, {"cone", Tip::cone}, {"ball", Tip::ball}},
             "Shape of the tool's tip; own: that of the tool's kind.");
    v.number(&P::tool_diameter_mm, "tool_diameter_mm", Range{0, 50},
             "Diameter of the shaft, or of the ball; 0: that of the tool's kind.");
    v.number(&P::tool_length_mm, "tool_length_mm", Range{0, 400},
             "Distance from the tip to the last point; 0: that of the tool's kind.");
    v.number(&P::tool_spacing_mm, "tool_spacing_mm", Range{0, 50},
             "Distance between the points; 0: that of the tool's kind.");
    v.choice(&P::tool_search, "tool_search",
             {{"both", Search::both}, {"tip_to_tail", Search::tip_to_tail}, {"tail_to_tip", Search::tail_to_tip}},
             "From which end the points are searched for one that collides. both: from both ends, the normals are "
             "averaged, and the tool may lock.");
    v.number(&P::lock_distance_mm, "lock_distance_mm", Range{0, 400},
             "A tool that is turned while points further apart than this collide is locked; 0: never.");
    v.text(&P::tool_points, "tool_points",
           "File with the points of --tool points: x y z in mm on each line, the tip at 0, the tail towards +z.")
        .not_always()
        .names("file");
    v.text(&P::tool_points_sha256, "tool_points_sha256",
           "What that file's SHA-256 must be; empty: any. A recording holds it, so that a replay has the same tool.")
        .not_always();
  }
};

/// The name of the choice that a member of P has: choice_name(params, "tool") is "needle".
template <class P>
std::string choice_name(const P& params, const char* name) {
  return std::get<std::string>(parameters_of<P>().find(name)->get(&params));
}

/// A kind of tool: what it can do and how it is felt and drawn. It is declared once, in tool_kinds.cpp; whatever asks
/// what a tool can do asks its kind, and no other source knows a tool by its name. docs/reference/hand-tools.md says
/// where the measures come from. Without more than a name, it is a point at the tip alone that does nothing.
struct ToolKind {
  /// What it removes while the pedal is down: what a rotating ball, cylinder or cylinder with a round end meets; or, of
  /// an incision, only what no rotating tool removes, such as skin.
  enum class Cut { nothing, ball, cylinder, rounded, incision };
  /// How it is drawn: what is felt in steel, with a handle behind it; a soft tube with a ring at each cm; a pen; a
  /// blade; a needle with a syringe; one with a handle across it; a screw on its driver.
  enum class Look { steel, tube, pen, blade, syringe, cross_handle, screw };

  const char* name;
  const char* german;  ///< its name in a German window
  const char* help;    ///< what it is, in a few words
  ToolParams::Tip tip = ToolParams::Tip::own;
  double diameter_mm = 0, length_mm = 0, spacing_mm = 0;  ///< length 0: a point at the tip alone
  bool exact = false;                                     ///< exactly round, without points
  bool has_neck = true;                                   ///< false: of a tip that is a ball, the ball alone is felt
  bool from_file = false;                                 ///< points of ToolParams::tool_points
  Cut cut = Cut::nothing;
  double cutting_mm = 0;         ///< of a cylinder, how far from the tip it cuts
  int flutes = 0;                ///< cutting edges of what rotates: what is heard of it
  std::vector<double> sizes_mm;  ///< the usual diameters of what rotates, ascending; a window's keys change them
  bool marks = false;            ///< while the pedal is down it draws on what it touches
  bool takes_up = false, rinses = false;  ///< while the pedal is down: blood and water; with saline
  Look look = Look::steel;

  bool cuts() const { return cut != Cut::nothing; }
  bool rotates() const { return cut == Cut::ball || cut == Cut::cylinder || cut == Cut::rounded; }

  ToolKind(const char* its_name, const char* in_german, const char* its_help)
      : name(its_name), german(in_german), help(its_help) {}
  // Each says one thing of the kind, and gives the kind.
  ToolKind& shaped(ToolParams::Tip its_tip, double diameter, double length, double spacing);
  ToolKind& exactly_round();
  ToolKind& ball_alone();
  ToolKind& of_a_file();
  ToolKind& cuts_with(Cut what);
  ToolKind& rotating(Cut what, int edges, double cutting = 0);
  ToolKind& sizes(std::vector<double> usual_mm);
  ToolKind& draws();
  ToolKind& suction();
  ToolKind& saline();
  ToolKind& looks(Look how);
};
const std::vector<ToolKind>& all_tool_kinds();
/// Throws Error 78 where there is no kind of that name.
const ToolKind& tool_kind(const std::string& name);

/// The parameters with the values of the tool's kind in place of 0 and `own`, and the hash of the file of points.
/// Throws Error 66 where that cannot be read, 64 where it is missing for its kind or given for another.
ToolParams own_tool(const ToolParams& params);

/// A rod with round ends about a tool's axis, or a ball where its middle line has no length.
struct RoundPart {
  double from_mm = 0, to_mm = 0;  ///< of the middle line, from the tip
  double radius_mm = 0;
};

/// A tool ready for the servo loop, in its own coordinates: the tip is at 0 and the tail towards +z. Points ascend from
/// the tip to the tail in rings about the axis, with each second ring turned by half a step.
struct Tool {
  std::vector<Vec3> points_mm;  ///< none: a point at the tip alone
  double length_mm = 0;
  std::vector<RoundPart> round;  ///< not empty: exactly round, without points; the first part has the tip
  ToolParams::Search search = ToolParams::Search::both;
  double lock_distance_mm = 3;
};
constexpr int max_tool_points = 2048;

/// Throws Error 78 where the tool would have more points than max_tool_points, or is shorter than its tip; for points
/// of a file as own_tool() does, 65 naming the line where it is no list of points, or is not the file of the hash.
Tool make_tool(const ToolParams& params);

using touch::frame_along, touch::frame_of, touch::rotation_between, touch::turned, touch::turned_about,
    touch::turned_to, touch::usable_across;

}  // namespace trephine::haptics
