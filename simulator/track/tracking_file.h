// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/params.h"
#include "base/vec3.h"

namespace trephine::track {

/// A tool before a tracker: where its tip is in the frame of the body that the tracker sees.
struct TrackedTool {
  int trephine_tool = 1;
  std::string body, lesson_tool;
  Vec3 tip_mm, axis{0, 0, 1};
  double tip_ball_mm = 0, residual_mm = 0, tip_error_mm = 0, spread_deg = 0;
  std::int64_t poses_count = 0, outliers_count = 0;
  template <class V>
  static void describe(V& v) {
    using P = TrackedTool;
    v.integer(&P::trephine_tool, "trephine_tool", Range{1, 1}, "The version of the format: 1.").is_required();
    v.text(&P::body, "body", "The tracker's name for the body that is fixed to it.").is_required();
    v.text(&P::lesson_tool, "lesson_tool", "The tool of a lesson for which it is taken; empty: any other.");
    v.numbers(&P::tip_mm, "tip_mm", Range{-1e4, 1e4}, "Its tip in the body's frame; of a ball its middle.")
        .is_required();
    v.number(&P::tip_ball_mm, "tip_ball_mm", Range{0, 20}, "Diameter of the ball that the tip is; 0: none.");
    v.numbers(&P::axis, "axis", Range{-1.000001, 1.000001}, "Unit, in the body's frame, from its tip to its tail.")
        .is_required();
    v.number(&P::residual_mm, "residual_mm", Range{0, 1e3},
             "Root mean square of how far the tip was off the place in which it rested.");
    v.number(&P::tip_error_mm, "tip_error_mm", Range{0, 1e3}, "Standard error of the tip, by leaving parts out.");
    v.number(&P::spread_deg, "spread_deg", Range{0, 90}, "How widely the tool was turned about its tip.");
    v.integer(&P::poses_count, "poses_count", Range{0, 1e9}, "Poses by which the tip was found.");
    v.integer(&P::outliers_count, "outliers_count", Range{0, 1e9}, "Poses that were left out.");
  }
  std::string fault() const;
};

struct TrackedTarget {
  std::string name;
  double error_mm = 0, left_out_mm = 0;
  template <class V>
  static void describe(V& v) {
    using P = TrackedTarget;
    v.text(&P::name, "name", "What a procedure aims at.").is_required();
    v.number(&P::error_mm, "error_mm", Range{0, 1e3}, "The expected error there, from the marks' residual.");
    v.number(&P::left_out_mm, "left_out_mm", Range{0, 1e3}, "Its standard error by leaving each mark out.");
  }
};

/// How a printed case lies before a tracker, and the tools that it sees: what --tracking takes.
struct Tracking {
  int trephine_tracking = 1;
  std::string case_token, case_sha256, print_sha256, reference, program;
  std::array<double, 12> reference_to_case{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
  std::int64_t marks_count = 0;
  double residual_mm = 0, left_out_mm = 0, target_error_mm = 0;
  std::vector<TrackedTarget> targets;
  std::vector<TrackedTool> tools;
  template <class V>
  static void describe(V& v) {
    using P = Tracking;
    v.integer(&P::trephine_tracking, "trephine_tracking", Range{1, 1}, "The version of the format: 1.").is_required();
    v.text(&P::case_token, "case", "The name of the case that was printed.").is_required();
    v.text(&P::case_sha256, "case_sha256", "SHA-256 of its case.json when it was printed.").is_required();
    v.text(&P::print_sha256, "print_sha256", "SHA-256 of the print's file.").is_required();
    v.text(&P::program, "program", "The program, with its version.").is_required();
    v.text(&P::reference, "reference", "The tracker's name for the body on the print; empty: the print never moves.");
    v.numbers(&P::reference_to_case, "reference_to_case", Range{-1e5, 1e5},
              "Rows of the matrix from a place before the reference to the case (LPS, mm), each with its offset.")
        .is_required();
    v.integer(&P::marks_count, "marks_count", Range{0, 99}, "Marks by which it was laid.");
    v.number(&P::residual_mm, "residual_mm", Range{0, 1e3}, "Root mean square of how far they are off.");
    v.number(&P::left_out_mm, "left_out_mm", Range{0, 1e3},
             "Root mean square of how far each mark is off where the others alone lay the case.");
    v.number(&P::target_error_mm, "target_error_mm", Range{0, 1e3},
             "The expected error where the procedure aims: the larger of both kinds, the largest of the targets.")
        .is_required();
    v.list(&P::targets, "targets", "The targets of the print.");
    v.list(&P::tools, "tools", "The tools.");
  }
  std::string fault() const;
};

std::string to_json(const TrackedTool& tool);
std::string to_json(const Tracking& tracking);
/// Throw Error 65 naming the field, 66; with the file.
TrackedTool read_tool(const std::filesystem::path& file);
Tracking read_tracking(const std::filesystem::path& file);

/// Number of the tool that is held for a tool of a lesson: that of this name, or the first that is for any, or the
/// first.
int tool_for(const Tracking& tracking, const std::string& lesson_tool);
/// How far a tool may really lie from where its poses say, at the targets: of the print's place and of its tip.
double place_error_mm(const Tracking& tracking);

}  // namespace trephine::track
