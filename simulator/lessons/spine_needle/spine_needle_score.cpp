// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/spine_needle/spine_needle_score.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace trephine {
namespace {

struct Rows {
  const SpineNeedleFacts& facts;
  const SpineNeedleRubric& rubric;
  const NeedlePass* pass;
  NeedleErrors errors;
  std::string doubt;  ///< why nothing is measured from the pedicle; empty: it is

  ScoreRow row(const char* name, const char* title, const FourLimits& limits, const std::string& unit) const {
    ScoreRow r;
    r.name = name;
    r.title = title;
    r.limits = {{"five_" + unit, limits.five},
                {"four_" + unit, limits.four},
                {"three_" + unit, limits.three},
                {"two_" + unit, limits.two}};
    return r;
  }
  // Of a figure that needs a needle in place and a pedicle that is sure.
  ScoreRow at_pedicle(const char* name, const char* title, const FourLimits& limits, const char* figure, double value,
                      const std::string& why) const {
    ScoreRow r = row(name, title, limits, "mm");
    if (!pass) {
      r.score = 1;
      r.why = "no needle lies in bone";
      return r;
    }
    r.decided_s = pass->end_s;
    if (!doubt.empty()) {
      r.why = doubt;
      r.decided_s.reset();
      return r;
    }
    r.measured = {{figure, value}};
    if (errors.entry_mm > rubric.farthest_mm.limit) {
      r.score = 1;
      r.why = "at no pedicle";
      return r;
    }
    r.score = limits.score(std::abs(value));
    r.why = why;
    return r;
  }
};

}  // namespace

LessonScore score_spine_needle(const SpineNeedleFacts& facts, const CaseManifest& manifest, const HapticVolume& before,
                               const SpineNeedleRubric& r) {
  const std::vector<CasePedicle> pedicles = pedicles_of(manifest);
  const int bone = spine_bone_of(manifest);
  Rows rows{facts, r, facts.final_pass(), {}, {}};
  if (rows.pass) {
    const NeedlePoint& end = rows.pass->path.back();
    rows.errors = nearest_pedicle(pedicles, end.tip_mm, end.axis);
    if (rows.errors.entry_mm <= r.farthest_mm.limit && rows.errors.pedicle->confidence < r.least_confidence_ratio.limit)
      rows.doubt = rows.errors.pedicle->name + " of this case is doubtful";
  }
  LessonScore score;
  const std::string at = rows.errors.pedicle ? rows.errors.pedicle->name : "";
  score.rows.push_back(rows.at_pedicle("entry", "Entry into the pedicle", r.entry_mm, "entry_off_mm",
                                       rows.errors.entry_mm, "the needle's line at the entry of " + at));
  score.rows.push_back(rows.at_pedicle("target", "Aim at the target", r.target_mm, "target_off_mm",
                                       rows.errors.target_mm, "the needle's line at the target of " + at));

  // Of all passes, each at the pedicle that it was nearest to.
  PedicleBreach worst;
  bool any = false, doubtful = false;
  for (const NeedlePass& pass : facts.passes) {
    const NeedleErrors e = nearest_pedicle(pedicles, pass.path.back().tip_mm, pass.path.back().axis);
    if (e.entry_mm > r.farthest_mm.limit) continue;
    if (e.pedicle->confidence < r.least_confidence_ratio.limit) {
      doubtful = true;
      continue;
    }
    any = true;
    const PedicleBreach b = find_breach(*e.pedicle, pass, before, bone);
    if (b.depth_mm > worst.depth_mm) worst = b;
  }
  ScoreRow breach = rows.row("breach", "Breach of the pedicle's wall", r.breach_mm, "mm");
  // A clean pass beside says nothing of the pedicle that is doubtful; a breach that was seen stays one.
  const bool breach_judged = !doubtful || worst.depth_mm > 0;
  if (breach_judged) {
    breach.score = any ? r.breach_mm.score(worst.depth_mm) : 1;
    breach.why = !any                 ? "the needle entered no pedicle"
                 : worst.depth_mm > 0 ? "through the " + worst.side + " wall"
                                      : std::string("within the pedicle");
    if (any) breach.measured = {{"breach_mm", worst.depth_mm}};
    if (worst.depth_mm > 0)
      breach.decided_s = worst.time_s;
    else if (any)
      breach.decided_s = facts.passes.back().end_s;
  } else {
    breach.why = "the pedicle of this case is doubtful";
  }
  score.rows.push_back(breach);

  const double depth = rows.errors.depth_mm;
  score.rows.push_back(rows.at_pedicle("depth", "Depth of the tip", r.depth_mm, "depth_beyond_target_mm", depth,
                                       depth > 0 ? "beyond the target" : "before the target"));

  ScoreRow exposure = rows.row("exposure", "Fluoroscopic exposure", r.exposure_s, "s");
  exposure.measured = {{"exposure_s", facts.exposure_s()}, {"shots_count", double(facts.shots.size())}};
  exposure.score = facts.shots.empty() ? 1 : r.exposure_s.score(facts.exposure_s());
  exposure.why = facts.shots.empty() ? "no picture was taken" : "X-rays were on";
  if (!facts.shots.empty()) exposure.decided_s = facts.shots.back().end_s;
  score.rows.push_back(exposure);

  ScoreRow passes = rows.row("passes", "Passes of the needle", r.passes_count, "count");
  const int count = int(facts.passes.size());
  passes.measured = {{"passes_count", double(count)}};
  passes.score = rows.pass ? r.passes_count.score(count) : 1;
  passes.why = rows.pass ? "times that the needle entered bone" : "no needle lies in bone";
  if (count > 0) passes.decided_s = facts.passes.back().begin_s;
  score.rows.push_back(passes);

  ScoreRow time = rows.row("time", "Time to complete procedure", r.procedure_s, "s");
  time.measured = {{"procedure_s", facts.procedure_s()}};
  if (facts.paused_s > 0) time.measured.emplace_back("paused_s", facts.paused_s);
  time.decided_s = facts.end_s;
  const bool finished = facts.end == LessonEnd::finished;
  const bool done = finished && count > 0;
  time.score = done ? r.procedure_s.score(facts.procedure_s()) : 1;
  time.why = done ? "completed"
                  : std::string("not completed: ") + (finished ? "the needle entered no bone" : name_of(facts.end));
  score.rows.push_back(time);

  const bool judged = rows.pass && rows.doubt.empty() && rows.errors.entry_mm <= r.farthest_mm.limit;
  using Value = decltype(LessonFigure::value);
  const Value unknown = std::monostate();
  score.figures = {{"passes_count", count},
                   {"shots_count", int(facts.shots.size())},
                   {"in_bone", rows.pass != nullptr},
                   {"at_pedicle", judged},
                   {"breached", breach_judged ? Value(worst.depth_mm > 0) : unknown},
                   {"medial", breach_judged ? Value(worst.side == "medial") : unknown},
                   {"turned_deg", judged ? Value(rows.errors.turned_deg) : unknown}};
  return score;
}

}  // namespace trephine
