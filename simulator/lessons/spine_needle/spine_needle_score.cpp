// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/spine_needle/spine_needle_score.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lessons/spine/spine_advice.h"
#include "lessons/spine/spine_critical.h"
#include "lessons/spine/spine_rows.h"
#include "lessons/spine/spine_scan.h"

namespace trephine::lessons {
namespace {

struct Rows {
  const SpineNeedleFacts& facts;
  const SpineNeedleRubric& rubric;
  const NeedlePass* pass;
  NeedleErrors errors;
  texts::Phrase doubt;  ///< why nothing is measured from the pedicle; empty: it is

  // Farther off a needle is at no pedicle, or not at the one that was asked for.
  double at_mm() const {
    return facts.task.empty() ? rubric.farthest_mm.limit
                              : std::min(rubric.farthest_mm.limit, rubric.entry_mm.two.limit);
  }
  bool at_it() const { return pass && errors.entry_mm <= at_mm(); }
  const char* not_there() const {
    return facts.task.empty() ? "at no pedicle" : "not at the pedicle that was asked for";
  }
  // Why the needle does not lie where it should; empty: it does, as far as the case knows.
  std::string nowhere(int bone) const {
    if (!pass) return "no needle lies in bone";
    if (pass->path.back().inside != bone) return "the needle's tip is outside of the bone";
    if (!doubt.empty()) return "";
    if (!at_it()) return not_there();
    if (errors.depth_mm < -rubric.depth_mm.two.limit) return "the tip does not reach the vertebra's body";
    return errors.target_mm > rubric.target_mm.two.limit ? "the needle misses the target" : "";
  }
  std::string unreached(const std::string& nowhere) const {
    if (facts.end != LessonEnd::finished) return name_of(facts.end);
    if (!nowhere.empty()) return nowhere == not_there() ? "the needle is " + nowhere : nowhere;
    if (entries_count(facts) > rubric.passes_count.two.limit) return "too many passes";
    return facts.procedure_s() > rubric.procedure_s.two.limit ? "not in the allotted time" : "";
  }

  // Of a figure that needs a needle in place and a pedicle that is sure.
  ScoreRow at_pedicle(const char* name, const char* title, const lesson::FourLimits& limits, const char* figure,
                      double value, const texts::Phrase& why) const {
    ScoreRow r = four_limits_row(name, title, limits, "mm");
    if (!doubt.empty()) {  // before all else: a case that does not know counts for nobody
      r.why = doubt;
      return r;
    }
    if (!pass) {
      r.score = 1;
      r.why = "no needle lies in bone";
      return r;
    }
    r.decided_s = pass->end_s;
    r.measured = {{figure, value}};
    if (!at_it()) {
      r.score = 1;
      r.why = not_there();
      return r;
    }
    r.score = limits.score(std::abs(value));
    r.why = why;
    return r;
  }
};

// What it was drawn back from was as deep as it was, in whatever pass at that pedicle.
void lower_by_deepest(ScoreRow& row, const CasePedicle& pedicle, const SpineNeedleFacts& facts, double depth_mm,
                      const lesson::FourLimits& limits) {
  const DeepestTip most = deepest_tip(pedicle, facts.passes);
  if (!row.score || most.beyond_mm <= std::max(0.0, depth_mm) + 0.5) return;
  row.measured.emplace_back("deepest_beyond_target_mm", most.beyond_mm);
  lower(row, limits.score(most.beyond_mm), "was too deep, and drawn back", most.time_s);
}

}  // namespace

LessonScore score_spine_needle(const SpineNeedleFacts& facts, const cases::CaseManifest& manifest,
                               const voxel::HapticVolume& before, const SpineNeedleRubric& r) {
  const std::vector<CasePedicle> pedicles = pedicles_of(manifest);
  const int bone = spine_bone_of(manifest);
  Rows rows{facts, r, facts.final_pass(), {}, {}};
  if (rows.pass) {
    const NeedlePoint& end = rows.pass->path.back();
    rows.errors = errors_at(pedicles, facts.task, end.tip_mm, end.axis);
    if (rows.at_it() && rows.errors.pedicle->confidence < r.least_confidence_ratio.limit)
      rows.doubt = doubtful(pedicle_phrase(rows.errors.pedicle->name));
  }
  for (const CasePedicle& p : pedicles)
    if (p.name == facts.task && p.confidence < r.least_confidence_ratio.limit)
      rows.doubt = doubtful(pedicle_phrase(p.name));
  const texts::Phrase unseen = unseen_in_scan(facts, true);
  if (!unseen.empty()) rows.doubt = unseen;
  LessonScore score;
  const std::string nowhere = rows.nowhere(bone);
  score.unreached = unseen.empty() ? texts::Phrase(rows.unreached(nowhere)) : unseen;
  CriticalErrors errors(r.critical_errors, score);
  note_spine_errors(facts, manifest, before, r.farthest_mm.limit, errors);
  // Nor did anybody save or spare anything who did harm.
  const texts::Phrase unsaved = unsaved_by(nowhere, !score.critical.empty());
  const texts::Phrase at = rows.errors.pedicle ? pedicle_phrase(rows.errors.pedicle->name) : "";
  score.rows.push_back(rows.at_pedicle("entry", "Entry into the pedicle", r.entry_mm, "entry_off_mm",
                                       rows.errors.entry_mm, {"the needle's line at the entry of {}", {at}}));
  score.rows.push_back(rows.at_pedicle("target", "Aim at the target", r.target_mm, "target_off_mm",
                                       rows.errors.target_mm, {"the needle's line at the target of {}", {at}}));

  // Of all passes, each at the pedicle that it was nearest to.
  PedicleBreach worst;
  bool any = false, any_doubtful = !rows.doubt.empty();
  for (const NeedlePass& pass : facts.passes) {
    const NeedleErrors e = nearest_pedicle(pedicles, pass.path.back().tip_mm, pass.path.back().axis);
    if (e.entry_mm > r.farthest_mm.limit) continue;
    if (e.pedicle->confidence < r.least_confidence_ratio.limit) {
      any_doubtful = true;
      continue;
    }
    any = true;
    const PedicleBreach b = find_breach(*e.pedicle, pass, before, bone);
    if (b.depth_mm > worst.depth_mm) worst = b;
  }
  ScoreRow breach = four_limits_row("breach", "Breach of the pedicle's wall", r.breach_mm, "mm");
  // A clean pass beside says nothing of the pedicle that is doubtful; a breach that was seen stays one.
  // Where a pedicle was asked for, it is the one that must be entered, and whose wall must be known.
  // And who stops short of the body spared no wall: it is judged where the needle came to where it should.
  if (!facts.task.empty()) any = rows.at_it();
  const bool breach_judged = facts.task.empty() ? !any_doubtful || worst.depth_mm > 0 : rows.doubt.empty();
  if (breach_judged) {
    breach.score = any && unsaved.empty() ? r.breach_mm.score(worst.depth_mm) : 1;
    const std::string clean = worst.depth_mm > 0 ? "through the " + worst.side + " wall" : "within the pedicle";
    breach.why = !any               ? (facts.task.empty() ? "the needle entered no pedicle" : rows.not_there())
                 : !unsaved.empty() ? unsaved
                                    : texts::Phrase(clean);
    if (any) breach.measured = {{"breach_mm", worst.depth_mm}};
    if (worst.depth_mm > 0)
      breach.decided_s = worst.time_s;
    else if (any)
      breach.decided_s = facts.passes.back().end_s;
  } else {
    breach.why = !unseen.empty() ? unseen : doubtful("the pedicle");
  }
  score.rows.push_back(breach);

  const double depth = rows.errors.depth_mm;
  ScoreRow depth_row = rows.at_pedicle("depth", "Depth of the tip", r.depth_mm, "depth_beyond_target_mm", depth,
                                       depth > 0 ? "beyond the target" : "before the target");
  if (rows.errors.pedicle) lower_by_deepest(depth_row, *rows.errors.pedicle, facts, depth, r.depth_mm);
  score.rows.push_back(depth_row);

  score.rows.push_back(exposure_row(facts, r.exposure_s, unsaved));
  score.rows.push_back(bone_passes_row(facts, r.passes_count, "Passes of the needle", r.insertion_mm_per_s, unsaved));
  score.rows.push_back(spine_time_row(facts, r.procedure_s, score.unsaved()));

  const bool judged = rows.at_it() && rows.doubt.empty();
  if (judged) {  // elsewhere the failure says it all
    score.advice = pedicle_advice(score, rows.errors);
    if (score.lost("breach") && worst.depth_mm > 0) score.advice.push_back(breach_advice(worst));
    if (score.lost("depth"))
      score.advice.push_back(depth_advice("depth", std::abs(depth) > r.depth_mm.five.limit
                                                       ? depth
                                                       : deepest_tip(*rows.errors.pedicle, facts.passes).beyond_mm));
  }
  using Value = decltype(LessonFigure::value);
  const Value unknown = std::monostate();
  score.figures = {{"passes_count", facts.from_scan ? unknown : Value(int(facts.passes.size()))},
                   {"shots_count", facts.from_scan ? unknown : Value(int(facts.shots.size()))},
                   {"in_bone", unseen.empty() ? Value(rows.pass != nullptr) : unknown},
                   {"at_pedicle", judged},
                   {"breached", breach_judged ? Value(worst.depth_mm > 0) : unknown},
                   {"medial", breach_judged ? Value(worst.side == "medial") : unknown},
                   {"turned_deg", judged ? Value(rows.errors.turned_deg) : unknown}};
  return score;
}

}  // namespace trephine::lessons
