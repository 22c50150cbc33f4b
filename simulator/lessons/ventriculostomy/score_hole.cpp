// SPDX-License-Identifier: GPL-3.0-or-later
// The rows of what is done before the catheter: landmarks and the burr hole.
#include <algorithm>
#include <cmath>

#include "lessons/ventriculostomy/score_parts.h"

namespace trephine::lessons::detail {
namespace {

template <class F>
BestTrace best_trace(const Scoring& s, double least_mm, F off_mm) {
  BestTrace best;
  for (const MarkerTrace& t : s.facts.traces) {
    if (t.length_mm < least_mm) continue;
    double most = 0;
    for (const Vec3& p : t.points_mm)
      if (const double off = off_mm(p); std::abs(off) > std::abs(most)) most = off;
    if (std::abs(most) < best.off_mm()) best = {most, t.length_mm, t.end_s};
  }
  return best;
}

// 2 where it was found, 1 where nearly, 0 where not.
int found(const BestTrace& best, const lesson::RubricLimit& limit, const lesson::RubricLimit& near) {
  return best.off_mm() <= limit.limit ? 2 : best.off_mm() <= near.limit ? 1 : 0;
}

texts::Phrase doubt_of(const Scoring& s) {
  const double least = s.rubric.burr_hole.least_confidence_ratio.limit;
  if (s.facts.drilled_beforehand) return "the hole was there beforehand";
  if (!s.frame.bregma_mm) return "the case has no bregma, so the coronal suture is not known";
  if (s.frame.suture_confidence < least) return doubtful("the coronal suture");
  if (s.frame.midline_confidence < least) return doubtful("the midline");
  return "";
}

// Where a hole lies, by Table XIII. Over the midline it lies on the side that nobody asked for, and is no better for
// lying far from the midline there.
std::pair<int, const char*> place_of(const Scoring& s, const BoneHole& hole, const cases::CaseLandmark& kocher) {
  const BurrHoleRubric& r = s.rubric.burr_hole;
  const Vec3 d = hole.outer_mm - kocher.position_mm;
  const double off = norm(d - hole.out * dot(d, hole.out));  // Kocher's point lies on the skin, the hole in the bone
  const double side = (s.on_left() ? 1 : -1) * s.frame.left_of_midline_mm(hole.outer_mm);
  const double before = s.frame.before_suture_mm(hole.outer_mm);
  if (side <= r.midline_mm.limit)
    return {1, side < -r.midline_mm.limit ? "placed on the other side" : "placed along the midline"};
  if (before < 0) return {1, "placed behind the coronal suture"};
  if (off <= r.kocher_mm.limit) return {5, "at Kocher's point"};
  if (off <= r.near_mm.limit) return {4, "near Kocher's point"};
  const double more_lateral = side - std::abs(s.frame.left_of_midline_mm(kocher.position_mm));
  const double more_anterior = before - s.frame.before_suture_mm(kocher.position_mm);
  // Towards midline and suture lies what must not be hit: a hole that errs that way is no better for erring the other
  // way as well. What counts as at Kocher's point is no error.
  if (std::max(more_lateral, more_anterior) <= 0 || std::min(more_lateral, more_anterior) < -r.kocher_mm.limit)
    return {2, "nearer to midline or suture than Kocher's point"};
  if (off > r.far_mm.limit) return {2, "far from Kocher's point"};
  return {3, more_lateral > more_anterior ? "too lateral" : "too anterior"};
}

}  // namespace

BestTrace best_midline(const Scoring& s) {
  return best_trace(s, s.rubric.landmarks.midline_trace_mm.limit,
                    [&](Vec3 p) { return s.frame.left_of_midline_mm(p); });
}
BestTrace best_suture(const Scoring& s) {
  return best_trace(s, s.rubric.landmarks.suture_trace_mm.limit, [&](Vec3 p) { return s.frame.before_suture_mm(p); });
}

const BoneHole& worst_hole(const Scoring& s, const cases::CaseLandmark& kocher) {
  const BoneHole* worst = &*s.facts.hole;
  for (const BoneHole& other : s.facts.holes)
    if (place_of(s, other, kocher).first < place_of(s, *worst, kocher).first) worst = &other;
  return *worst;
}

ScoreRow score_landmarks(const Scoring& s) {
  ScoreRow row{"landmarks", "Anatomy and landmarks", {}, s.facts.from_scan ? not_shown(s.facts) : doubt_of(s), {}, {},
               {}};
  if (!row.why.empty()) return row;
  const LandmarksRubric& r = s.rubric.landmarks;
  const BestTrace midline = best_midline(s), suture = best_suture(s);
  const int of_midline = found(midline, r.midline_mm, r.midline_near_mm);
  const int of_suture = found(suture, r.suture_mm, r.suture_near_mm);
  // Table XIII: 1 neither, 3 one of the two, 5 both. One that was nearly found adds one, and never makes up for one
  // found.
  const int well = (of_midline == 2) + (of_suture == 2), nearly = (of_midline == 1) + (of_suture == 1);
  row.score = 1 + 2 * well + (nearly > 0 ? 1 : 0);
  constexpr const char* how[] = {"not", "nearly", "well"};
  row.why = {"midline {} identified, coronal suture {} identified", {how[of_midline], how[of_suture]}};
  if (midline.any()) row.measured = {{"midline_off_mm", midline.off_mm()}, {"midline_trace_mm", midline.length_mm}};
  if (suture.any()) {
    row.measured.emplace_back("suture_off_mm", suture.off_mm());
    row.measured.emplace_back("suture_trace_mm", suture.length_mm);
  }
  row.limits = {
      {"midline_mm", r.midline_mm}, {"midline_near_mm", r.midline_near_mm}, {"midline_trace_mm", r.midline_trace_mm},
      {"suture_mm", r.suture_mm},   {"suture_near_mm", r.suture_near_mm},   {"suture_trace_mm", r.suture_trace_mm}};
  if (of_midline + of_suture > 0)
    row.decided_s = std::max(of_midline > 0 ? midline.end_s : 0, of_suture > 0 ? suture.end_s : 0);
  else if (!s.facts.traces.empty())
    row.decided_s = s.facts.traces.back().end_s;
  return row;
}

ScoreRow score_burr_hole(const Scoring& s) {
  ScoreRow row{"burr_hole", "Burr hole placement", {}, doubt_of(s), {}, {}, {}};
  if (!row.why.empty()) return row;
  const BurrHoleRubric& r = s.rubric.burr_hole;
  const auto decide = [&](int score, const char* why) {
    row.score = score;
    row.why = why;
    return row;
  };
  const cases::CaseLandmark* kocher = find_landmark(s.manifest, s.on_left() ? "kocher_left" : "kocher_right");
  if (!kocher || kocher->confidence < r.least_confidence_ratio.limit) {
    row.why = kocher ? doubtful("Kocher's point") : "the case has no Kocher's point";
    return row;
  }
  if (s.facts.from_scan && !s.facts.from_volume && !s.facts.hole) {
    row.why = "the CT shows no hole that is sure";
    return row;
  }
  if (!s.facts.hole || !s.facts.hole->drilled) return decide(1, "no hole was drilled");
  // Wherever the catheter went in.
  const BoneHole& hole = worst_hole(s, *kocher);
  row.decided_s = s.facts.through_s >= 0 ? s.facts.through_s : s.facts.end_s;
  const Vec3 d = hole.outer_mm - kocher->position_mm;
  const double off = norm(d - hole.out * dot(d, hole.out));
  const double side = (s.on_left() ? 1 : -1) * s.frame.left_of_midline_mm(hole.outer_mm);
  const double before = s.frame.before_suture_mm(hole.outer_mm);
  row.measured = {
      {"kocher_off_mm", off}, {"lateral_mm", side}, {"before_suture_mm", before}, {"removed_mm3", hole.removed_mm3}};
  if (s.facts.burr_mm > 0) row.measured.emplace_back("burr_mm", s.facts.burr_mm);
  row.limits = {{"midline_mm", r.midline_mm}, {"kocher_mm", r.kocher_mm}, {"near_mm", r.near_mm}, {"far_mm", r.far_mm}};
  if (!s.facts.hole->through) return decide(1, "the hole does not let the catheter through");
  const auto [score, why] = place_of(s, hole, *kocher);
  return decide(score, why);
}

}  // namespace trephine::lessons::detail
