// SPDX-License-Identifier: GPL-3.0-or-later
#include "scoring/score_spine_needle.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "voxel/decode.h"

namespace trephine {
namespace {

constexpr double after_entry_mm = 4;  // nearer to the entry the wall is the surface that the needle enters by
constexpr double farthest_wall_mm = 40, walk_mm = 0.2;
constexpr int directions = 12;

// Where a line from the tip along the axis passes the plane through `at` across `normal`.
Vec3 passes(Vec3 tip, Vec3 axis, Vec3 at, Vec3 normal) {
  const double slope = dot(axis, normal);
  if (std::abs(slope) < 0.05) return tip;  // nearly along the plane: it passes nowhere near
  return tip + axis * (dot(at - tip, normal) / slope);
}

// From the axis to its wall that way; a vessel's hole of a millimetre is none.
double wall_mm(const HapticDecoder& volume, int bone, Vec3 from, Vec3 way) {
  double last = 0;
  for (double t = 0; t < farthest_wall_mm && t - last < 1; t += walk_mm)
    if (volume.trilinear(bone, from + way * t) >= 0.5) last = t;
  return last;
}

const char* side_of(const CasePedicle& p, Vec3 way) {
  const Vec3 f = p.forwards(), up = normalized(Vec3{0, 0, 1} - f * f.z);
  const double side = p.name.find("_left") != std::string::npos ? 1 : -1;
  const Vec3 outer = normalized(Vec3{side, 0, 0} - f * (side * f.x));
  const double o = dot(way, outer), u = dot(way, up);
  if (std::abs(u) > std::abs(o)) return u > 0 ? "upper" : "lower";
  return o > 0 ? "lateral" : "medial";
}

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

NeedleErrors needle_errors(const CasePedicle& p, Vec3 tip, Vec3 axis) {
  const Vec3 f = p.forwards();
  NeedleErrors e;
  e.pedicle = &p;
  e.entry_mm = norm(passes(tip, axis, p.entry_mm, f) - p.entry_mm);
  e.target_mm = norm(passes(tip, axis, p.target_mm, f) - p.target_mm);
  e.depth_mm = dot(tip - p.target_mm, f);
  e.turned_deg = std::acos(std::clamp(-dot(axis, f), -1.0, 1.0)) * 180 / M_PI;
  return e;
}

NeedleErrors nearest_pedicle(const std::vector<CasePedicle>& pedicles, Vec3 tip, Vec3 axis) {
  NeedleErrors best;
  for (const CasePedicle& p : pedicles) {
    const NeedleErrors e = needle_errors(p, tip, axis);
    if (!best.pedicle || e.entry_mm < best.entry_mm) best = e;
  }
  return best;
}

PedicleBreach find_breach(const CasePedicle& p, const NeedlePass& pass, const HapticVolume& volume, int bone) {
  const Vec3 f = p.forwards();
  const double length = norm(p.target_mm - p.entry_mm);
  const Vec3 up = normalized(Vec3{0, 0, 1} - f * f.z), across = cross(up, f);
  const HapticDecoder decoder(volume);
  PedicleBreach worst;
  const auto look = [&](Vec3 at, double time_s) {
    const double along = dot(at - p.entry_mm, f);
    if (along < after_entry_mm || along > length) return;
    const Vec3 on_axis = p.entry_mm + f * along;
    for (int n = 0; n < directions; ++n) {  // each side of the needle
      const double turn = 2 * M_PI * n / directions;
      const Vec3 off = at - on_axis + (across * std::cos(turn) + up * std::sin(turn)) * (0.5 * pass.diameter_mm);
      const double off_mm = norm(off);
      if (!(off_mm > 1e-6)) continue;
      const double beyond = off_mm - wall_mm(decoder, bone, on_axis, off / off_mm);
      if (beyond > worst.depth_mm) worst = {beyond, side_of(p, off), at, time_s};
    }
  };
  for (const NeedlePoint& n : pass.path) look(n.tip_mm, n.time_s);
  if (!pass.path.empty()) {
    const NeedlePoint& last = pass.path.back();
    for (double t = 0; t < std::min(length + 40, pass.length_mm); t += 0.5)
      look(last.tip_mm + last.axis * t, last.time_s);
  }
  // Less than the volume's own step is none.
  if (worst.depth_mm < 0.5 * volume.voxels.spacing_mm.x) worst = {};
  return worst;
}

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
