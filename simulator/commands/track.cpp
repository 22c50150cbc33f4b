// SPDX-License-Identifier: GPL-3.0-or-later
// A tracker's tools and a print before it: calibrated, registered and checked.
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <iostream>

#include "base/error.h"
#include "base/hash.h"
#include "base/progress.h"
#include "base/refusal.h"
#include "base/text.h"
#include "base/write_file.h"
#include "cli/argument.h"
#include "cli/command.h"
#include "track/pivot.h"
#include "track/pose_source.h"
#include "track/print_registration.h"
#include "track/tracking_file.h"

namespace trephine::commands {
namespace {

using Kind = cli::Argument::Kind;

struct PivotCommandParams {
  std::string tool_body, reference_body, lesson_tool;
  double tip_ball_mm = 0;
  int pivot_poses = 400, spin_poses = 200;
  template <class V>
  static void describe(V& v) {
    using P = PivotCommandParams;
    v.text(&P::tool_body, "tool_body", "The tracker's name for the body on the tool, such as StylusToTracker.");
    v.text(&P::reference_body, "reference_body",
           "Its name for a body beside the hollow, which may then move; empty: poses are of the tracker's own frame.");
    v.text(&P::lesson_tool, "lesson_tool", "Which tool of a lesson it is, such as catheter; empty: any other.");
    v.number(&P::tip_ball_mm, "tip_ball_mm", Range{0, 20},
             "Diameter of the ball that the tip is, such as a burr's: the tool is turned about its middle, and touches "
             "and drills with its foremost point.");
    v.integer(&P::pivot_poses, "pivot_poses", Range{40, 100000}, "Poses that are taken while it is tilted.");
    v.integer(&P::spin_poses, "spin_poses", Range{0, 100000},
              "Poses that are taken while it is turned about its axis; 0: the axis leads from the tip to the body's "
              "origin.");
  }
};

struct RegisterCommandParams {
  std::string reference_body, marks;
  int mark_poses = 150, check_poses = 30;
  template <class V>
  static void describe(V& v) {
    using P = RegisterCommandParams;
    v.text(&P::reference_body, "reference_body",
           "The tracker's name for the body on the print; empty: the print never moves.");
    v.text(&P::marks, "marks", "Numbers of the marks that are touched, such as 1,2,4,7; empty: all.");
    v.integer(&P::mark_poses, "mark_poses", Range{10, 100000}, "Poses that are taken on each mark.");
    v.integer(&P::check_poses, "check_poses", Range{1, 100000}, "Poses that are taken of each tool on a mark.");
  }
};

void say(const std::string& line) { std::cout << line << "\n" << std::flush; }

// Until Enter is pressed; a byte at a time, for more may wait behind it.
void wait_for_enter() {
  const Progress progress({}, &cancel_requested());
  while (true) {
    progress.check();
    pollfd p{STDIN_FILENO, POLLIN, 0};
    if (poll(&p, 1, 100) <= 0) continue;
    char c = 0;
    if (read(STDIN_FILENO, &c, 1) != 1)
      throw Error(ExitCode::usage, "", "", "the input ended, and Enter is needed to begin");
    if (c == '\n') return;
  }
}

std::vector<RigidMap> asked(track::PoseSource& source, int tool, int count, const std::string& what) {
  say(what + ", and press Enter");
  wait_for_enter();
  return source.take(tool, std::size_t(count), Progress({}, &cancel_requested()));
}

Vec3 mean_tip(const std::vector<RigidMap>& poses, Vec3 tip_mm) {
  Vec3 sum;
  for (const RigidMap& p : poses) sum += p(tip_mm);
  return sum / double(poses.size());
}

ExitCode run_pivot(const cli::ParsedCommand& parsed) {
  const auto& p = parsed.params<PivotCommandParams>();
  if (p.tool_body.empty())
    throw Error(ExitCode::usage, "", "--tool-body", "is needed: the tracker's name for the tool");
  if (p.spin_poses > 0 && p.spin_poses < int(track::least_poses))
    throw Error(ExitCode::usage, "", "--spin-poses",
                fmt::format("{}, must be 0 or at least {}", p.spin_poses, track::least_poses));
  if (p.tool_body == p.reference_body) throw Error(ExitCode::usage, "", "--reference-body", "is the tool itself");
  track::PoseSource source(parsed.params<track::TrackerParams>(), {p.tool_body}, p.reference_body);
  const track::PivotTip tip = track::pivot_tip(
      asked(source, 0, p.pivot_poses,
            "rest the tip in a small hollow, be ready to tilt the tool slowly by 30 degrees to all sides"),
      parsed.params<track::PivotParams>());
  track::TrackedTool tool;
  tool.body = p.tool_body;
  tool.lesson_tool = p.lesson_tool;
  tool.tip_ball_mm = p.tip_ball_mm;
  tool.tip_mm = tip.tip_mm;
  tool.residual_mm = tip.residual_mm;
  tool.tip_error_mm = tip.tip_error_mm;
  tool.spread_deg = tip.spread_deg;
  tool.poses_count = std::int64_t(tip.used);
  tool.outliers_count = std::int64_t(tip.outliers);
  say(fmt::format(
      "tip at {:.2f}, {:.2f}, {:.2f} mm of the body: {:.2f} mm off its place, known to {:.2f} mm; turned by "
      "{:.0f} degrees, {} of {} poses left out",
      tip.tip_mm.x, tip.tip_mm.y, tip.tip_mm.z, tip.residual_mm, tip.tip_error_mm, tip.spread_deg, tip.outliers,
      tip.used + tip.outliers));
  tool.axis = normalized(-tip.tip_mm);
  if (p.spin_poses > 0)
    tool.axis =
        track::spin_axis(asked(source, 0, p.spin_poses,
                               "leave the tip there, hold the tool upright, be ready to turn it about its axis"),
                         tip.tip_mm);
  if (norm(tool.axis) == 0)
    throw refusal("axis", "the tip is the body's origin, so its direction is not known", {"set `spin_poses`"});
  write_file(parsed.path("out"), track::to_json(tool));
  return ExitCode::ok;
}

// Places in the record of the marks that are named.
std::vector<std::size_t> marks_of(const std::string& text, const lesson::PrintRecord& print) {
  std::vector<std::size_t> all;
  if (text.empty()) {
    for (std::size_t n = 0; n < print.marks.size(); ++n) all.push_back(n);
    return all;
  }
  for (const std::string& piece : split_at(text, ',')) {
    const std::optional<long long> number = parse_integer(trimmed(piece));
    const auto is = std::find_if(print.marks.begin(), print.marks.end(),
                                 [&](const lesson::PrintMark& m) { return number && m.number == *number; });
    const auto place = std::size_t(is - print.marks.begin());
    if (is == print.marks.end() || std::find(all.begin(), all.end(), place) != all.end())
      throw Error(ExitCode::usage, "", "--marks", printable(piece) + ": there is no such mark, or it is named twice");
    all.push_back(place);
  }
  return all;
}

// The tip of each tool, held on a mark, must seem to be there.
void check_tools(track::PoseSource& source, const std::vector<track::TrackedTool>& tools, const RigidMap& to_case,
                 const lesson::PrintRecord& print, int poses, const track::MarkParams& params) {
  for (std::size_t n = 0; n < tools.size(); ++n) {
    const Vec3 tip = to_case(
        mean_tip(asked(source, int(n), poses, "check: hold the tip of " + printable(tools[n].body) + " on any mark"),
                 tools[n].tip_mm));
    const double off = track::check_off_mm(print, tip, tools[n].tip_ball_mm);
    say(fmt::format("{}: {:.2f} mm off the nearest mark", printable(tools[n].body), off));
    if (!(off <= params.largest_check_mm))
      throw refusal("tools",
                    fmt::format("{} is {:.1f} mm off the nearest mark, at most {:g} (largest_check_mm) are allowed: a "
                                "body has moved on its tool or on the print, or two bodies were exchanged",
                                printable(tools[n].body), off, params.largest_check_mm),
                    {"fix the bodies, find the tip of each `tool_body` again, and register the print again"});
  }
}

std::vector<std::string> bodies_of(const std::vector<track::TrackedTool>& tools) {
  std::vector<std::string> all;
  for (const track::TrackedTool& t : tools) all.push_back(t.body);
  return all;
}

ExitCode run_register_print(const cli::ParsedCommand& parsed) {
  const auto& p = parsed.params<RegisterCommandParams>();
  track::MarkParams params = parsed.params<track::MarkParams>();
  const std::string file = parsed.text("print");
  const lesson::PrintRecord print = lesson::read_print(file);
  track::Tracking t;
  for (const std::string& tool : parsed.all("tool")) {
    t.tools.push_back(track::read_tool(tool));
    const track::TrackedTool& last = t.tools.back();
    bool twice = last.body == p.reference_body;
    for (std::size_t n = 0; n + 1 < t.tools.size(); ++n) twice = twice || t.tools[n].body == last.body;
    if (twice) throw Error(ExitCode::usage, tool, "body", last.body + ", is another tool's, or the reference");
  }
  params.tip_ball_mm = t.tools.front().tip_ball_mm;
  const std::vector<std::size_t> marks = marks_of(p.marks, print);
  if (marks.size() < lesson::least_marks)
    throw Error(ExitCode::usage, file, "--marks",
                fmt::format("{} are given, at least {} are needed", marks.size(), lesson::least_marks));
  track::PoseSource source(parsed.params<track::TrackerParams>(), bodies_of(t.tools), p.reference_body);
  std::vector<Vec3> middles;
  for (const std::size_t n : marks) {
    const lesson::PrintMark& mark = print.marks[n];
    std::vector<Vec3> tips;
    for (const RigidMap& pose : asked(source, 0, p.mark_poses,
                                      fmt::format("mark {} ({} of {}): hold the tip on it, be ready to slide it over "
                                                  "the whole sphere",
                                                  mark.number, middles.size() + 1, marks.size())))
      tips.push_back(pose(t.tools.front().tip_mm));
    middles.push_back(track::mark_middle(tips, 0.5 * mark.diameter_mm, int(mark.number), params));
  }
  const track::PrintPlace place = track::place_print(print, marks, middles, params);
  for (const std::size_t n : place.exchanged)
    say(fmt::format("warning: another mark than {} was touched when it was asked for; it was recognised",
                    print.marks[marks[n]].number));
  t.case_token = print.case_token;
  t.case_sha256 = print.case_sha256;
  t.print_sha256 = sha256_of_bytes(lesson::to_json(print));
  t.program = "trephine-sim " TREPHINE_VERSION;
  t.reference = p.reference_body;
  t.reference_to_case = rows_of(place.reference_to_case);
  t.marks_count = std::int64_t(place.fit.marks);
  t.residual_mm = place.fit.residual_mm;
  t.left_out_mm = place.left_out_mm;
  t.target_error_mm = place.target_error_mm;
  t.targets = place.targets;
  say(fmt::format("{} of {} marks, {:.2f} mm off; each by the others alone {:.2f} mm", place.fit.marks, marks.size(),
                  place.fit.residual_mm, place.left_out_mm));
  for (const track::TrackedTarget& target : place.targets)
    say(fmt::format("expected error at {}: {:.2f} mm, {:.2f} mm by leaving marks out", printable(target.name),
                    target.error_mm, target.left_out_mm));
  check_tools(source, t.tools, place.reference_to_case, print, p.check_poses, params);
  say(fmt::format("a tool may lie {:.2f} mm off where the procedure aims; rows with a smaller limit are not judged",
                  track::place_error_mm(t)));
  write_file(parsed.path("out"), track::to_json(t));
  return ExitCode::ok;
}

struct CheckCommandParams {
  int check_poses = 30;
  template <class V>
  static void describe(V& v) {
    v.integer(&CheckCommandParams::check_poses, "check_poses", Range{1, 100000},
              "Poses that are taken of each tool on a mark.");
  }
};

ExitCode run_check_print(const cli::ParsedCommand& parsed) {
  const track::Tracking t = track::read_tracking(parsed.path("tracking"));
  const lesson::PrintRecord print = lesson::read_print(parsed.path("print"));
  if (sha256_of_bytes(lesson::to_json(print)) != t.print_sha256)
    throw Error(ExitCode::bad_input, parsed.text("tracking"), "print_sha256",
                "another print than that of --print was registered");
  track::PoseSource source(parsed.params<track::TrackerParams>(), bodies_of(t.tools), t.reference);
  check_tools(source, t.tools, map_of(t.reference_to_case), print, parsed.params<CheckCommandParams>().check_poses,
              parsed.params<track::MarkParams>());
  return ExitCode::ok;
}

}  // namespace

const cli::OwnCommand track_pivot_command([] {
  cli::Command c;
  c.name = "track pivot";
  c.summary = "finds the tip of a tool that a tracker sees";
  c.description =
      "The tip rests in a small hollow while the tool is tilted to all sides, and then while it is turned about its "
      "axis; a tracker's server sends the poses of a body on it by OpenIGTLink. Where the tip is, and its error by "
      "leaving parts out, is written to --out, for `trephine-sim track register`. A tip about which the tool was "
      "turned "
      "too little, that slipped, or that is known too badly is refused (80). docs/how-to/track.md leads through it.";
  c.arguments = {cli::required_argument("out", Kind::out_file, "Write the tool to this file (.json).")};
  c.groups = {cli::ParameterGroup::of<PivotCommandParams>("Parameters"),
              cli::ParameterGroup::of<track::PivotParams>("What is refused"),
              cli::ParameterGroup::of<track::TrackerParams>("Tracker by OpenIGTLink")};
  c.examples = {
      "trephine-sim track pivot --tracker-host tracker.local --tool-body StylusToTracker --reference-body "
      "HeadToTracker "
      "--out stylus.tool.json"};
  c.run = run_pivot;
  return c;
});

const cli::OwnCommand track_register_command([] {
  cli::Command c;
  c.name = "track register";
  c.summary = "finds where a printed case is before a tracker";
  c.description =
      "The tip of the first --tool is slid over the registration marks of a print (`trephine export --format print`), "
      "one after the other. The middles of the spheres lay the print before the reference body that is fixed to it. "
      "Residual, expected error at the targets and the error by leaving each mark out are printed. A mirrored "
      "arrangement, other distances than the print's, fewer than four marks and errors above the limits are refused "
      "(80). At last each tool is held on a mark, which shows whether two bodies were exchanged. --out is for "
      "`--device openigtlink --tracking FILE`.";
  cli::Argument tool = cli::required_argument(
      "tool", Kind::in_file, "A tool, as `trephine-sim track pivot` wrote it; the first touches the marks.");
  tool.repeated = true;
  c.arguments = {cli::required_argument("print", Kind::in_file, "NAME-print.json of the print."), tool,
                 cli::required_argument("out", Kind::out_file, "Write the registration to this file (.json).")};
  c.groups = {cli::ParameterGroup::of<RegisterCommandParams>("Parameters"),
              cli::ParameterGroup::of<track::MarkParams>("What is refused"),
              cli::ParameterGroup::of<track::TrackerParams>("Tracker by OpenIGTLink")};
  c.examples = {
      "trephine-sim track register --tracker-host tracker.local --print printed/head-01-print.json --reference-body "
      "HeadToTracker --tool stylus.tool.json --tool catheter.tool.json --out head.tracking.json"};
  c.run = run_register_print;
  return c;
});

const cli::OwnCommand track_check_command([] {
  cli::Command c;
  c.name = "track check";
  c.summary = "checks that tracked tools and a print are where they were registered";
  c.description =
      "Each tool is held on a mark of the print, as at the end of `trephine-sim track register`; one that seems to be "
      "off it is refused (80).";
  c.arguments = {cli::required_argument("tracking", Kind::in_file, "As `trephine-sim track register` wrote it."),
                 cli::required_argument("print", Kind::in_file, "NAME-print.json of the same print.")};
  c.groups = {cli::ParameterGroup::of<CheckCommandParams>("Parameters"),
              cli::ParameterGroup::of<track::MarkParams>("What is refused"),
              cli::ParameterGroup::of<track::TrackerParams>("Tracker by OpenIGTLink")};
  c.examples = {"trephine-sim track check --tracking head.tracking.json --print printed/head-01-print.json"};
  c.run = run_check_print;
  return c;
});

}  // namespace trephine::commands
