// SPDX-License-Identifier: GPL-3.0-or-later
// The rows of the catheter and of time.
#include <algorithm>
#include <cmath>

#include "lessons/time_row.h"
#include "lessons/ventriculostomy/score_parts.h"
#include "voxel/decode.h"

namespace trephine::lessons::detail {
namespace {

const char* no_catheter = "no catheter lies in the brain";

// Why a row of the catheter cannot be judged by a CT; empty where it can.
texts::Phrase unseen(const Scoring& s) {
  if (!s.facts.from_scan || !s.facts.passes.empty()) return "";
  if (s.facts.from_volume) return not_shown(s.facts);
  return s.facts.seen == lesson::Sighting::doubtful ? "what the CT shows of a catheter is doubtful"
                                                    : "the CT shows no catheter";
}
constexpr double outside_most_mm = 10;  // farther from the ventricles it is said no more exactly
constexpr double directed_mm = 20;      // of brain, after which a pass that was drawn out again has a direction
constexpr double beyond_doubt_mm = 5;   // of the midline: nearer to it a side is none

Vec3 tip_of(const CatheterPass& pass) { return pass.path.back().tip_mm; }

int beyond(std::size_t count, int needed) { return std::max(0, int(count) - needed); }

// Holes and incisions that nobody needed, also those that were taken back.
int extra_holes(const Scoring& s) { return beyond(s.facts.holes.size(), s.facts.drilled_beforehand ? 0 : 1); }
int extra_incisions(const Scoring& s) { return beyond(s.facts.incisions.size(), s.facts.drilled_beforehand ? 0 : 1); }
int entries(const Scoring& s) { return int(s.facts.passes.size()) + extra_holes(s) + extra_incisions(s); }

// Why the goal was not reached; empty: the catheter lies where it should, by a way that may be gone.
texts::Phrase misplaced(const Scoring& s) {
  const CatheterPass* pass = s.final_pass();
  if (!pass) return no_catheter;
  if (pass->path.back().inside != s.shapes.ventricles) return "the catheter lies in no ventricle";
  if (in_third_ventricle(s, *pass, pass->path.back())) return "the catheter lies in the third ventricle";
  if ((s.frame.left_of_midline_mm(tip_of(*pass)) > 0) != s.on_left())
    return "the catheter lies in the contralateral ventricle";
  for (const CatheterPass& any : s.facts.passes)
    for (const PassPoint& p : any.path)
      if (in_third_ventricle(s, any, p)) return "the catheter passed the third ventricle";
  if (const ScoreRow hole = score_burr_hole(s); hole.score && *hole.score == 1) return {"burr hole: {}", {hole.why}};
  if (s.rubric.passes && entries(s) > s.rubric.passes->two.limit) return "too many passes, holes or incisions";
  return "";
}

// How far to the left what was done lies; by default right, as the table's figures.
double done_left_mm(const Scoring& s) {
  const Vec3 at = s.facts.hole              ? s.facts.hole->outer_mm
                  : !s.facts.passes.empty() ? s.facts.passes.back().entry_mm
                                            : s.frame.nasion_mm - s.frame.left;
  return s.frame.left_of_midline_mm(at);
}

}  // namespace

bool Scoring::on_left() const { return facts.task.empty() ? done_left_mm(*this) > 0 : facts.task == "left"; }
bool Scoring::side_known() const { return !facts.task.empty() || std::abs(done_left_mm(*this)) > beyond_doubt_mm; }

texts::Phrase Scoring::foramen_doubt() const {
  double confidence = 0;
  if (!foramen_of(manifest, on_left(), &confidence)) return "the case has no foramen of Monro on that side";
  return confidence < rubric.tip.least_confidence_ratio.limit ? doubtful("the foramen of Monro") : "";
}

std::string Scoring::critical_at(const CatheterPass& pass, const PassPoint& p) const {
  for (const cases::CaseShape& shape : manifest.haptic.shapes)
    if (shape.number == p.inside)
      for (const char* name : critical_names)
        if (shape.name == name) return name;
  // Of the third ventricle only its liquor counts: its walls are brain like all else. Nor does what lies at the
  // foramen, to which the catheter goes: a zone's border there is known to some millimetres.
  const CriticalRubric& r = rubric.critical;
  const std::optional<Vec3> target = foramen();
  const bool sure = target && foramen_doubt().empty();
  const double below = sure ? dot(*target - p.tip_mm, frame.upwards) : r.third_ventricle_below_mm.limit;
  const bool in_liquor = p.inside == shapes.ventricles && below >= r.third_ventricle_below_mm.limit;
  if (zones.holds("sagittal_sinus", pass.entry_mm) || zones.holds("sagittal_sinus", p.tip_mm)) return "sagittal_sinus";
  if (in_liquor && zones.holds("third_ventricle", p.tip_mm)) return "third_ventricle";
  if (zones.holds("brainstem", p.tip_mm)) return "brainstem";
  if (zones.holds("eloquent_zone", p.tip_mm)) return "eloquent_zone";
  if (!zones.has("sagittal_sinus") && std::abs(frame.left_of_midline_mm(pass.entry_mm)) <= r.sinus_mm.limit)
    return "sagittal_sinus";
  if (!sure) return "";  // what is measured from the foramen would be a guess
  const double side = std::abs(frame.left_of_midline_mm(p.tip_mm));
  if (!zones.has("third_ventricle") && in_liquor && side <= r.third_ventricle_mm.limit) return "third_ventricle";
  if (zones.has("brainstem")) return "";
  return side <= r.brainstem_mm.limit && below >= r.brainstem_below_mm.limit ? "brainstem" : "";
}

double distance_to_ventricles_mm(const Scoring& s, Vec3 tip, double most_mm) {
  const voxel::HapticDecoder decoder(s.before);
  constexpr double step_mm = 0.25;
  constexpr int ways = 256;
  for (double r = 0; r < most_mm; r += step_mm)
    for (int n = 0; n < (r > 0 ? ways : 1); ++n) {
      const double z = 1 - (2 * n + 1.0) / ways, a = n * M_PI * (3 - std::sqrt(5.0)), q = std::sqrt(1 - z * z);
      if (decoder.trilinear(s.shapes.ventricles, tip + Vec3{q * std::cos(a), q * std::sin(a), z} * r) >= 0.5) return r;
    }
  return most_mm;
}

// Where the catheter's line meets the table: a plane across the hole there.
double depth_mm(const Scoring& s, const CatheterPass& pass) { return depth_mm(s, pass, tip_of(pass)); }

double depth_mm(const Scoring& s, const CatheterPass& pass, Vec3 tip) {
  Vec3 out = normalized(pass.entry_mm - tip);
  if (out == Vec3{}) out = pass.out;
  if (!s.facts.hole) return norm(pass.entry_mm - tip);
  const BoneHole& hole = *s.facts.hole;
  const Vec3 at = s.rubric.depth.measured_from == DepthRubric::From::outer_table ? hole.outer_mm : hole.inner_mm;
  const double across = dot(out, hole.out);
  return across > 0.2 ? dot(at - tip, hole.out) / across : norm(at - tip);
}

Deepest deepest(const Scoring& s) {
  Deepest most;
  for (const CatheterPass& pass : s.facts.passes)
    for (const PassPoint& p : pass.path)
      if (const double depth = depth_mm(s, pass, p.tip_mm); depth > most.depth_mm) most = {depth, p.time_s};
  return most;
}

LineMiss line_miss(const CatheterPass& pass, Vec3 foramen) {
  Vec3 tip = tip_of(pass);
  if (!pass.in_place)
    for (const PassPoint& p : pass.path)
      if (dot(pass.entry_mm - p.tip_mm, pass.out) > dot(pass.entry_mm - tip, pass.out)) tip = p.tip_mm;
  LineMiss m;
  m.entry_mm = pass.entry_mm;
  m.way = normalized(tip - pass.entry_mm);
  if (m.way == Vec3{}) m.way = -pass.out;
  m.length_mm = dot(foramen - pass.entry_mm, m.way);
  m.to_foramen_mm = foramen - pass.entry_mm - m.way * m.length_mm;
  return m;
}

ScoreRow score_trajectory(const Scoring& s) {
  const TrajectoryRubric& r = s.rubric.trajectory;
  ScoreRow row{"trajectory", "Trajectory of catheter insertion", {}, "", {}, {}, {}};
  row.limits = {
      {"midline_mm", r.midline_mm}, {"ideal_mm", r.ideal_mm}, {"good_mm", r.good_mm}, {"lateral_mm", r.lateral_mm}};
  const auto decide = [&](int score, const texts::Phrase& why, double time_s) {
    row.score = score;
    row.why = why;
    row.decided_s = time_s;
    return row;
  };
  const double own_side = s.on_left() ? 1 : -1;
  double across = 0;
  for (const CatheterPass& pass : s.facts.passes)
    for (const PassPoint& p : pass.path) across = std::max(across, -own_side * s.frame.left_of_midline_mm(p.tip_mm));
  if (!s.facts.passes.empty()) row.measured = {{"beyond_midline_mm", across}};
  // Doubt comes before all else: a case that does not know counts for nobody, whatever was done or left.
  row.why = unseen(s);
  if (row.why.empty()) row.why = s.foramen_doubt();
  if (!row.why.empty()) return row;
  if (s.facts.passes.empty()) {
    row.score = 1;
    row.why = "no catheter entered the brain";
    return row;
  }
  // What any pass hit counts, not the last one's alone.
  for (const CatheterPass& pass : s.facts.passes)
    for (const PassPoint& p : pass.path) {
      if (-own_side * s.frame.left_of_midline_mm(p.tip_mm) > r.midline_mm.limit)
        return decide(1, "traverses the midline", p.time_s);
      if (const std::string name = s.critical_at(pass, p); !name.empty()) {
        std::string said = name;
        std::replace(said.begin(), said.end(), '_', ' ');
        return decide(1, "passes through the " + said, p.time_s);
      }
    }
  // Of all passes that went so deep that they had a direction, the one that missed by most; the last one has it anyway.
  const CatheterPass* worst = &s.facts.passes.back();
  const auto off_mm = [&](const CatheterPass& p) { return norm(line_miss(p, *s.foramen()).to_foramen_mm); };
  for (const CatheterPass& p : s.facts.passes) {
    double deep_mm = 0;
    for (const PassPoint& at : p.path) deep_mm = std::max(deep_mm, dot(p.entry_mm - at.tip_mm, p.out));
    if (deep_mm >= directed_mm && off_mm(p) > off_mm(*worst)) worst = &p;
  }
  const CatheterPass& pass = *worst;
  const Vec3 miss = line_miss(pass, *s.foramen()).to_foramen_mm;
  const double off = norm(miss), lateral = -own_side * dot(miss, s.frame.left);
  row.measured.emplace_back("line_off_foramen_mm", off);
  row.measured.emplace_back("line_off_lateral_mm", lateral);
  const double end_s = pass.path.back().time_s;
  if (off <= r.ideal_mm.limit) return decide(5, "ideal path", end_s);
  if (off <= r.good_mm.limit) return decide(4, "nearly ideal path", end_s);
  const char* how = lateral > 0 ? "too lateral" : "too medial";
  if (off <= r.lateral_mm.limit) return decide(3, std::string(how) + ", avoids critical structures", end_s);
  return decide(2, std::string("far ") + how + ", avoids critical structures", end_s);
}

ScoreRow score_depth(const Scoring& s) {
  const DepthRubric& r = s.rubric.depth;
  ScoreRow row{"depth", "Depth of catheter insertion", {}, "", {}, {}, {}};
  row.limits = {{"least_mm", r.least_mm},           {"low_mm", r.low_mm},   {"ideal_low_mm", r.ideal_low_mm},
                {"ideal_high_mm", r.ideal_high_mm}, {"high_mm", r.high_mm}, {"most_mm", r.most_mm}};
  row.why = unseen(s);
  if (!row.why.empty()) return row;
  const CatheterPass* pass = s.final_pass();
  if (!pass) {
    row.score = 1;
    row.why = no_catheter;
    return row;
  }
  const double depth = depth_mm(s, *pass);
  row.measured = {{"depth_mm", depth}};
  row.decided_s = pass->path.back().time_s;
  const auto score_at = [&](double mm) {
    return mm < r.least_mm.limit || mm > r.most_mm.limit             ? 1
           : mm < r.low_mm.limit || mm > r.high_mm.limit             ? 2
           : mm < r.ideal_low_mm.limit || mm > r.ideal_high_mm.limit ? 3
                                                                     : 5;
  };
  row.score = score_at(depth);
  row.why = *row.score == 5 ? "ideal depth" : depth < r.ideal_low_mm.limit ? "not deep enough" : "too deep";
  // What it was drawn back from was as deep as it was.
  const Deepest most = deepest(s);
  if (most.depth_mm > depth + 0.5) row.measured.emplace_back("deepest_mm", most.depth_mm);
  if (most.depth_mm > std::max(depth, r.ideal_high_mm.limit))
    lower(row, score_at(most.depth_mm), "was too deep, and drawn back", most.time_s);
  return row;
}

ScoreRow score_tip(const Scoring& s) {
  const TipRubric& r = s.rubric.tip;
  ScoreRow row{"tip", "Final location of catheter tip", {}, "", {}, {}, {}};
  row.limits = {{"foramen_mm", r.foramen_mm}, {"near_mm", r.near_mm}};
  const CatheterPass* pass = s.final_pass();
  const auto decide = [&](int score, const char* why) {
    row.score = score;
    row.why = why;
    if (pass) row.decided_s = pass->path.back().time_s;
    return row;
  };
  const std::optional<Vec3> target = s.foramen();
  if (pass) {
    const Vec3 tip = tip_of(*pass);
    const bool inside = pass->path.back().inside == s.shapes.ventricles;
    row.measured = {{"outside_ventricles_mm", inside ? 0 : distance_to_ventricles_mm(s, tip, outside_most_mm)}};
    if (target) row.measured.emplace_back("foramen_off_mm", norm(tip - *target));
  }
  row.why = unseen(s);
  if (row.why.empty()) row.why = s.foramen_doubt();
  if (!row.why.empty()) return row;
  if (!pass) return decide(1, no_catheter);
  const PassPoint& end = pass->path.back();
  if (end.inside != s.shapes.ventricles) return decide(1, "not in the ventricle");
  if (in_third_ventricle(s, *pass, end)) return decide(2, "in the third ventricle");
  const double own_side = s.on_left() ? 1 : -1, off = norm(end.tip_mm - *target);
  if (own_side * s.frame.left_of_midline_mm(end.tip_mm) < 0) return decide(3, "in the contralateral ventricle");
  if (off <= r.foramen_mm.limit) return decide(5, "at the ipsilateral foramen of Monro");
  if (off <= r.near_mm.limit) return decide(4, "near the ipsilateral foramen of Monro");
  return decide(3, "in the ipsilateral ventricle");
}

ScoreRow score_passes(const Scoring& s, bool harmed) {
  const lesson::FourLimits& r = *s.rubric.passes;
  const int count = int(s.facts.passes.size());
  ScoreRow row{"passes", "Passes, holes and incisions", 1, "no catheter entered the brain", {}, {}, {}};
  row.beside = true;
  if (s.facts.from_scan) {
    row.score.reset();
    row.why = not_shown(s.facts);
    return row;
  }
  row.measured = {{"passes_count", double(count)},
                  {"incisions_count", double(s.facts.incisions.size())},
                  {"holes_count", double(s.facts.holes.size())}};
  row.limits = {{"five_count", r.five}, {"four_count", r.four}, {"three_count", r.three}, {"two_count", r.two}};
  if (count == 0) return row;
  row.decided_s = s.facts.passes.back().begin_s;
  // One pass that ends beside the ventricle saved nobody anything.
  const texts::Phrase why = unsaved_by(misplaced(s), harmed);
  row.score = why.empty() ? r.score(entries(s)) : 1;
  row.why = !why.empty()             ? why
            : extra_holes(s) > 0     ? "more holes than were needed"
            : extra_incisions(s) > 0 ? "more incisions than were needed"
                                     : "times that the catheter entered the brain";
  lower_by_speed(row, s.facts, s.rubric.insertion_mm_per_s);
  return row;
}

bool in_third_ventricle(const Scoring& s, const CatheterPass& pass, const PassPoint& p) {
  return s.foramen_doubt().empty() && s.critical_at(pass, p) == "third_ventricle";
}

texts::Phrase unreached_goal(const Scoring& s) {
  if (const texts::Phrase why = unseen(s); !why.empty()) return why;
  if (s.facts.end != LessonEnd::finished) return name_of(s.facts.end);
  if (const texts::Phrase why = misplaced(s); !why.empty()) return why;
  return s.facts.procedure_s() > s.rubric.time.allotted_s.limit ? "not in the allotted time" : "";
}

void note_critical(const Scoring& s, LessonScore& score) {
  CriticalErrors errors(s.rubric.critical_errors, score);
  const VentriculostomyFacts& f = s.facts;
  const auto through = [&](Vec3 source) {
    SeenAt seen;
    if (f.hole) seen.wound = Wound{source, f.hole->outer_mm, std::max(2.5, f.burr_mm)};
    return seen;
  };
  if (f.dura && f.dura->breach)
    errors.happened("dura_by_burr", "the burr breached the dura", f.dura->breach->time_s,
                    through(f.dura->breach->at_mm));
  for (const CatheterPass& pass : f.passes)
    for (const PassPoint& p : pass.path) {
      const std::string name = s.critical_at(pass, p);
      std::string said = name;
      std::replace(said.begin(), said.end(), '_', ' ');
      if (!name.empty()) errors.happened(name, "the catheter passed the " + said, p.time_s, through(pass.entry_mm));
    }
  if (!f.task.empty()) {
    const double own_side = f.task == "left" ? 1 : -1;
    const auto wrong = [&](Vec3 at) { return own_side * s.frame.left_of_midline_mm(at) < -beyond_doubt_mm; };
    for (const LessonIncision& i : f.incisions)
      if (wrong(i.at_mm)) errors.happened("wrong_side", "the skin was cut on the wrong side", i.time_s);
    for (const BoneHole& hole : f.holes)
      if (wrong(hole.outer_mm)) errors.happened("wrong_side", "the hole was drilled on the wrong side", hole.begin_s);
    if (f.hole && f.hole->drilled && wrong(f.hole->outer_mm))
      errors.happened("wrong_side", "the hole was drilled on the wrong side", f.drill_begin_s);
    for (const CatheterPass& pass : f.passes)
      if (wrong(pass.entry_mm)) errors.happened("wrong_side", "the catheter went in on the wrong side", pass.begin_s);
  }
  const CatheterPass* pass = s.final_pass();
  if (f.end == LessonEnd::finished && pass && pass->path.back().inside != s.shapes.ventricles)
    errors.happened("dry_catheter", "a catheter that draws no CSF was called done", f.end_s);
}

}  // namespace trephine::lessons::detail

namespace trephine::lessons {

LessonScore score_ventriculostomy(const VentriculostomyFacts& facts, const cases::CaseManifest& manifest,
                                  const voxel::HapticVolume& before, const VentriculostomyRubric& rubric,
                                  const CriticalZones& zones) {
  const detail::Scoring s{facts, manifest, before, rubric, head_frame_of(manifest), head_shapes_of(manifest), zones};
  LessonScore score;
  score.unreached = detail::unreached_goal(s);
  detail::note_critical(s, score);
  score.rows = {detail::score_landmarks(s), detail::score_burr_hole(s), detail::score_trajectory(s),
                detail::score_depth(s),     detail::score_tip(s),       time_row(facts, rubric.time, score.unreached)};
  if (rubric.passes) score.rows.push_back(detail::score_passes(s, !score.critical.empty()));
  bool in_ventricle = false, first_pass = false, contralateral = false, third_ventricle = false;
  if (const CatheterPass* pass = s.final_pass(); pass && !pass->path.empty()) {
    const PassPoint& end = pass->path.back();
    in_ventricle = end.inside == s.shapes.ventricles;
    third_ventricle = detail::in_third_ventricle(s, *pass, end);
    contralateral = in_ventricle && !third_ventricle && (s.frame.left_of_midline_mm(end.tip_mm) > 0) != s.on_left();
    first_pass = in_ventricle && !third_ventricle && !contralateral && facts.passes.size() == 1;
  }
  score.figures = {{"passes_count", int(facts.passes.size())},
                   {"in_ventricle", in_ventricle},
                   {"first_pass", first_pass},
                   {"contralateral", contralateral},
                   {"third_ventricle", third_ventricle}};
  // The grade of its place [Kakarla2008]: 1 the frontal horn of its side or the third ventricle, 2 the other lateral
  // ventricle, 3 what must not be entered. What of the brain is eloquent a case seldom shows: then it has no grade.
  LessonFigure& grade = score.figures.emplace_back(LessonFigure{"kakarla_grade", std::monostate{}});
  if (const CatheterPass* pass = s.final_pass(); pass && !pass->path.empty() && s.foramen_doubt().empty()) {
    const PassPoint& end = pass->path.back();
    constexpr double frontal_horn_mm = 30;  // from the foramen: other horns lie farther away
    const std::optional<Vec3> foramen = s.foramen();
    if (contralateral)
      grade.value = 2;
    else if (third_ventricle || (in_ventricle && foramen && norm(end.tip_mm - *foramen) <= frontal_horn_mm))
      grade.value = 1;
    else if (const std::string zone = s.critical_at(*pass, end); zone == "brainstem" || zone == "eloquent_zone")
      grade.value = 3;
  }
  if (facts.from_scan)
    for (LessonFigure& figure : score.figures)
      if (facts.passes.empty() || figure.name == "passes_count" || figure.name == "first_pass")
        figure.value = std::monostate{};
  const auto of_dura = [&](const char* name, auto value) {
    score.figures.push_back({name, std::monostate{}});
    if (facts.dura) score.figures.back().value = value(*facts.dura);
  };
  score.advice = detail::advice_of(s, score);
  of_dura("dura_passed", [](const DuraFacts& d) { return !d.pops.empty(); });
  of_dura("dura_breached", [](const DuraFacts& d) { return d.breach.has_value(); });
  of_dura("burr_on_dura_n", [](const DuraFacts& d) { return d.burr_n; });
  return score;
}

}  // namespace trephine::lessons
