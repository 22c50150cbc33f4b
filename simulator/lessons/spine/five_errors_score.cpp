// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/spine/five_errors_score.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lessons/spine/spine_advice.h"
#include "lessons/spine/spine_critical.h"
#include "lessons/spine/spine_rows.h"
#include "lessons/spine/spine_scan.h"

namespace trephine::lessons {
namespace {

constexpr double reach_mm = 20;    // farther before the target the tip lies in the pedicle alone
constexpr double at_task_mm = 10;  // farther from its entry a screw is not in the pedicle that was asked for

struct Words {
  const char *nowhere, *it_is, *in_bone;  // why nothing is judged; how what is wrong with its place begins; a figure
};
constexpr Words words_of_screw{"no screw lies in bone", "the screw is ", "screw_in_bone"},
    words_of_finder{"no finder lies in bone", "the finder is ", "finder_in_bone"};

// From b to a as they are seen in the plane of two of the vertebra's axes; both go forwards: positive where a leans
// more to `across`.
double seen_deg(Vec3 a, Vec3 b, Vec3 across, Vec3 anterior) {
  const double d = std::atan2(dot(a, across), dot(a, anterior)) - std::atan2(dot(b, across), dot(b, anterior));
  return std::remainder(d, 2 * M_PI) * 180 / M_PI;
}

// Whether the screw is as long and as wide as the pedicle wants it: its head on the bone, its thread filling the
// pedicle without bursting it. `none`: why it is at no pedicle, or why the pedicle is not known.
ScoreRow size_row(const FiveErrorsRubric& r, const NeedlePass* pass, const NeedleErrors& e,
                  const voxel::HapticVolume& before, int bone, const texts::Phrase& none, bool judged) {
  ScoreRow row{"size", "Size of the screw", {}, none, {}, {}, {}};
  row.beside = true;
  row.limits = {{"head_mm", *r.head_mm}, {"widest_ratio", *r.widest_ratio}, {"narrowest_ratio", *r.narrowest_ratio}};
  if (!judged) return row;
  row.score = 1;
  if (!none.empty()) return row;
  const double width = pedicle_width_mm(*e.pedicle, before, bone);
  const double depth = e.depth_mm + norm(e.pedicle->target_mm - e.pedicle->entry_mm);
  const double head = pass->length_mm - depth, ratio = width > 0 ? pass->diameter_mm / width : 0;
  row.measured = {{"head_out_mm", head}, {"fill_ratio", ratio}, {"pedicle_width_mm", width}};
  row.decided_s = pass->end_s;
  const bool length = std::abs(head) <= r.head_mm->limit, wide = ratio <= r.widest_ratio->limit,
             narrow = ratio >= r.narrowest_ratio->limit;
  row.score = length && wide && narrow ? 5 : !length && !(wide && narrow) ? 1 : 3;
  row.why = !length  ? (head > 0 ? "too long for where its tip lies" : "too short for where its tip lies")
            : !wide  ? "too wide for the pedicle"
            : narrow ? "fits the pedicle"
                     : "too narrow for the pedicle";
  return row;
}

// Whether a finder made the screw's way: near its entry, and to that share of its depth.
bool finder_led(const SpineNeedleFacts& facts, const NeedlePass& screw, double share) {
  const NeedlePoint& to = screw.deepest();
  return std::any_of(facts.passes.begin(), facts.passes.end(), [&](const NeedlePass& p) {
    return p.tool == "finder" && p.begin_s < screw.begin_s && norm(p.entry_mm - screw.entry_mm) <= at_task_mm &&
           p.depth_mm(p.deepest()) >= share * screw.depth_mm(to);
  });
}

// What it cost: X-rays, passes, time, each where the rubric says limits. `nowhere`: why no screw lies where it should.
void push_effort_rows(const SpineNeedleFacts& facts, const cases::CaseManifest& manifest, const FiveErrorsRubric& r,
                      const NeedlePass* screw, const texts::Phrase& nowhere, LessonScore& score) {
  const auto push = [&](ScoreRow row) {
    row.beside = true;
    score.rows.push_back(std::move(row));
  };
  if (r.exposure_s) {
    ScoreRow row = exposure_row(facts, *r.exposure_s, nowhere);
    if (facts.shots.empty() && manifest.ct.file.empty() && !facts.from_scan) {  // nobody could have taken one
      row.score.reset();
      row.why = "the case holds no CT";
    }
    push(row);
  }
  if (r.passes_count) {
    ScoreRow row = bone_passes_row(facts, *r.passes_count, "Passes through bone", r.insertion_mm_per_s, nowhere);
    if (screw && is_screw(*screw) && !facts.from_scan && r.finder_ratio &&
        !finder_led(facts, *screw, r.finder_ratio->limit))
      lower(row, 1, "no finder went before the screw", screw->begin_s);
    push(row);
  }
  if (r.procedure_s) push(spine_time_row(facts, *r.procedure_s, score.unsaved()));
}

}  // namespace

bool is_screw(const NeedlePass& pass) { return pass.tool.rfind("screw", 0) == 0; }

LessonScore score_five_errors(const SpineNeedleFacts& facts, const cases::CaseManifest& manifest,
                              const voxel::HapticVolume& before, const FiveErrorsRubric& r, JudgedTool tool) {
  const std::vector<CasePedicle> pedicles = pedicles_of(manifest);
  const int bone = spine_bone_of(manifest);
  const NeedlePass* pass = facts.final_pass();
  const Words& say = tool == JudgedTool::screw ? words_of_screw : words_of_finder;
  if (pass && is_screw(*pass) != (tool == JudgedTool::screw)) pass = nullptr;
  NeedleErrors e;
  PedicleBreach breach;
  Vec3 entry_off;
  double entry = 0, axial = 0, sagittal = 0;
  texts::Phrase doubt;
  std::string none = pass ? "" : say.nowhere;
  if (pass) {
    const NeedlePoint& end = pass->path.back();
    e = errors_at(pedicles, facts.task, end.tip_mm, end.axis);
    const Vec3 f = e.pedicle->forwards(), way = -end.axis, front = e.pedicle->anterior();
    // Where its line passes the vertebra's coronal plane through the entry.
    const double slope = dot(way, front);
    const Vec3 from = end.tip_mm - e.pedicle->entry_mm;
    entry_off = std::abs(slope) > 0.05 ? from - way * (dot(from, front) / slope) : from;
    entry_off = entry_off - front * dot(entry_off, front);
    entry = norm(entry_off);
    axial = seen_deg(way, f, e.pedicle->left, front);
    sagittal = seen_deg(way, f, e.pedicle->cranial, front);
    // Of finder and screw: a wall that was broken through is broken.
    for (const NeedlePass& p : facts.passes) {
      const NeedlePoint& at = p.deepest();
      if (&p != pass && needle_errors(*e.pedicle, at.tip_mm, at.axis).entry_mm > at_task_mm) continue;
      if (const PedicleBreach b = find_breach(*e.pedicle, p, before, bone); b.depth_mm > breach.depth_mm) breach = b;
    }
    if (e.pedicle->confidence < r.least_confidence_ratio.limit) doubt = doubtful(pedicle_phrase(e.pedicle->name));
    if (e.entry_mm > (facts.task.empty() ? r.farthest_mm.limit : std::min(r.farthest_mm.limit, at_task_mm)))
      none = facts.task.empty() ? "at no pedicle" : "not at the pedicle that was asked for";
  }
  for (const CasePedicle& p : pedicles)
    if (p.name == facts.task && p.confidence < r.least_confidence_ratio.limit) {
      doubt = doubtful(pedicle_phrase(p.name));
      none.clear();  // a case that does not know counts for nobody
    }
  const texts::Phrase unseen = unseen_in_scan(facts);
  if (!unseen.empty()) doubt = unseen, none.clear();
  LessonScore score;
  const char* const too_short = pass && none.empty() && doubt.empty() && e.depth_mm < -reach_mm
                                    ? "the tip does not reach the vertebra's body"
                                    : "";
  const double depth_mm = pass ? e.depth_mm + norm(e.pedicle->target_mm - e.pedicle->entry_mm) : 0;
  const bool proud = tool == JudgedTool::screw && pass && none.empty() && doubt.empty() && r.proud_mm &&
                     pass->length_mm - depth_mm > r.proud_mm->limit;
  // What our rows beside the five errors are judged by: who stops short of the body has placed no screw.
  const std::string nowhere = !pass ? say.nowhere : !none.empty() ? none : too_short;
  score.unreached = facts.end != LessonEnd::finished ? name_of(facts.end)
                    : !unseen.empty()                ? unseen
                    : !pass                          ? say.nowhere
                    : !none.empty()                  ? say.it_is + none
                    : *too_short                     ? too_short
                    : proud                          ? "the screw's head stands far out of the bone"
                    : r.passes_count && entries_count(facts) > r.passes_count->two.limit ? "too many passes"
                    : r.procedure_s && facts.procedure_s() > r.procedure_s->two.limit    ? "not in the allotted time"
                                                                                         : "";
  CriticalErrors critical(r.critical_errors, score);
  note_spine_errors(facts, manifest, before, r.farthest_mm.limit, critical);
  int errors = 0;
  const auto row = [&](const char* name, const char* title, const char* figure, double value, const char* limit_name,
                       const lesson::RubricLimit& limit, const texts::Phrase& why) {
    ScoreRow s;
    s.name = name;
    s.title = title;
    s.limits = {{limit_name, limit}};
    if (pass && doubt.empty()) s.measured = {{figure, value}};
    if (!none.empty() || doubt.empty()) {
      const bool wrong = !none.empty() || std::abs(value) > limit.limit;
      errors += wrong;
      s.score = wrong ? 1 : 5;
      s.why = !none.empty() ? none : texts::Phrase(wrong ? "an error: {}" : "no error: {}", {why});
      if (pass) s.decided_s = pass->end_s;
    } else {
      s.why = doubt;
    }
    score.rows.push_back(s);
  };
  row("entry", "Coronal entry point", "coronal_entry_off_mm", entry, "entry_mm", r.entry_mm, "in the coronal plane");
  row("axial", "Axial deviation", "axial_off_deg", std::abs(axial), "axial_deg", r.axial_deg, "in the axial plane");
  row("sagittal", "Sagittal deviation", "sagittal_off_deg", std::abs(sagittal), "sagittal_deg", r.sagittal_deg,
      "in the sagittal plane");
  // As deep as finder or screw ever was: what was drawn back from there was there.
  const double length = pass ? std::max(e.depth_mm, deepest_tip(*e.pedicle, facts.passes).beyond_mm) : 0;
  const double far = std::abs(length) > std::abs(e.depth_mm) && length > 0 ? length : e.depth_mm;
  row("length", "Length", "tip_beyond_target_mm", far, "length_mm", r.length_mm,
      far > e.depth_mm + 0.5 ? "was too deep, and drawn back"
      : e.depth_mm > 0       ? "the tip lies beyond the target"
                             : "the tip lies before the target");
  row("breach", "Pedicle breach", "breach_mm", breach.depth_mm, "breach_mm", r.breach_mm,
      breach.depth_mm > 0 ? "through the " + breach.side + " wall" : "within the pedicle");
  const texts::Phrase of_five("{} of five errors", {std::to_string(errors)});
  const bool judged = doubt.empty() || !none.empty(), acceptable = none.empty() && errors <= r.most_errors_count.limit;
  if (judged && score.unreached.empty() && !acceptable) score.unreached = of_five;
  ScoreRow last;
  last.name = "acceptable";
  last.title = "Acceptable";
  last.limits = {{"most_errors_count", r.most_errors_count}};
  last.why = !judged ? doubt : !none.empty() ? texts::Phrase(none) : of_five;
  if (judged) {
    last.score = acceptable ? 5 : 1;
    if (none.empty()) last.measured = {{"errors_count", double(errors)}};
    if (pass) last.decided_s = pass->end_s;
  }
  score.rows.push_back(last);
  if (tool == JudgedTool::screw && r.head_mm && r.widest_ratio && r.narrowest_ratio)
    score.rows.push_back(size_row(r, pass, e, before, bone, !doubt.empty() ? doubt : nowhere, doubt.empty()));
  push_effort_rows(facts, manifest, r, pass, unsaved_by(nowhere, !score.critical.empty()), score);
  if (pass && doubt.empty() && none.empty()) {  // elsewhere the failure says it all
    score.advice = five_errors_advice(score, e, entry_off, axial, sagittal, tool == JudgedTool::screw);
    if (score.lost("length")) score.advice.push_back(depth_advice("length", far));
    if (score.lost("breach") && breach.depth_mm > 0) score.advice.push_back(breach_advice(breach));
  }
  using Value = decltype(LessonFigure::value);
  const Value unknown = std::monostate();
  score.figures = {{"errors_count", judged ? Value(errors) : unknown},
                   {"acceptable", judged ? Value(acceptable) : unknown},
                   {say.in_bone, unseen.empty() ? Value(pass != nullptr) : unknown}};
  if (tool == JudgedTool::screw) {
    score.figures.push_back({"screw_length_mm", pass ? Value(pass->length_mm) : unknown});
    score.figures.push_back({"screw_diameter_mm", pass ? Value(pass->diameter_mm) : unknown});
  }
  score.figures.push_back({"passes_count", facts.from_scan ? unknown : Value(int(facts.passes.size()))});
  score.figures.push_back({"shots_count", facts.from_scan ? unknown : Value(int(facts.shots.size()))});
  const bool graded = pass && none.empty() && doubt.empty();
  const PedicleBreach lies = graded ? breach_in_place(*e.pedicle, *pass, before, bone) : PedicleBreach();
  const char* const walls[] = {"medial_wall_mm", "lateral_wall_mm", "upper_wall_mm", "lower_wall_mm"};  // Wall
  for (int wall = 0; wall < 4; ++wall)
    score.figures.push_back({walls[wall], graded ? Value(lies.walls_mm[wall]) : unknown});
  score.figures.push_back({"gertzbein_grade", graded ? Value(gertzbein_grade(lies)) : unknown});
  return score;
}

}  // namespace trephine::lessons
