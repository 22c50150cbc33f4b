// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "lessons/ventriculostomy/ventriculostomy_score.h"

namespace trephine::lessons::detail {

/// What every row is scored from.
struct Scoring {
  const VentriculostomyFacts& facts;
  const cases::CaseManifest& manifest;
  const voxel::HapticVolume& before;
  const VentriculostomyRubric& rubric;
  HeadFrame frame;
  HeadShapes shapes;
  const CriticalZones& zones;

  const CatheterPass* final_pass() const {
    return !facts.passes.empty() && facts.passes.back().in_place ? &facts.passes.back() : nullptr;
  }
  /// The side that was asked for; else that of the hole, or of the catheter where there is none.
  bool on_left() const;
  bool side_known() const;  ///< it was asked for, or what was done lies clearly beside the midline
  std::optional<Vec3> foramen() const { return foramen_of(manifest, on_left()); }
  /// Why nothing can be measured from the foramen; empty where it can.
  texts::Phrase foramen_doubt() const;
  /// "sagittal_sinus", "third_ventricle", "brainstem", "eloquent_zone" or "" for a point of a catheter's way.
  std::string critical_at(const CatheterPass& pass, const PassPoint& p) const;
};

/// How the last pass's line misses the foramen: of a pass that was drawn out again its deepest point tells the way.
struct LineMiss {
  Vec3 entry_mm, way;    ///< where the line begins, and its direction
  Vec3 to_foramen_mm;    ///< from the line's nearest point to the foramen
  double length_mm = 0;  ///< from the entry to that point, along the line
};
LineMiss line_miss(const CatheterPass& pass, Vec3 foramen_mm);

/// A trace that was to lie on a plane: how far its worst point lies off, signed along the plane's normal.
struct BestTrace {
  double signed_off_mm = 1e9, length_mm = 0, end_s = 0;
  double off_mm() const { return signed_off_mm < 0 ? -signed_off_mm : signed_off_mm; }
  bool any() const { return off_mm() < 1e9; }
};
/// Of all traces that are long enough, the one whose worst point lies off least: of the midline (to the left), of the
/// suture (in front of it).
BestTrace best_midline(const Scoring& s);
BestTrace best_suture(const Scoring& s);

/// Of all holes that were drilled the one that lies worst by Table XIII; there must be one.
const BoneHole& worst_hole(const Scoring& s, const cases::CaseLandmark& kocher);

ScoreRow score_landmarks(const Scoring& s);
ScoreRow score_burr_hole(const Scoring& s);
ScoreRow score_trajectory(const Scoring& s);
ScoreRow score_depth(const Scoring& s);
ScoreRow score_tip(const Scoring& s);
ScoreRow score_passes(const Scoring& s, bool harmed);
/// Why the catheter does not lie where it should; empty where it does, and the lesson was finished in time.
texts::Phrase unreached_goal(const Scoring& s);

/// How far the tip is from the ventricles, at most `most_mm`; most_mm and more where none is within that.
double distance_to_ventricles_mm(const Scoring& s, Vec3 tip_mm, double most_mm);
/// Whether the tip is in the third ventricle; of a case whose foramina are doubtful nobody knows it.
bool in_third_ventricle(const Scoring& s, const CatheterPass& pass, const PassPoint& p);
void note_critical(const Scoring& s, LessonScore& score);
/// What to do otherwise, of the rows that lost points by a place or a direction.
std::vector<Advice> advice_of(const Scoring& s, const LessonScore& score);
/// Along the catheter, from the table of the bone that the rubric says to the tip.
double depth_mm(const Scoring& s, const CatheterPass& pass, Vec3 tip_mm);
double depth_mm(const Scoring& s, const CatheterPass& pass);
/// The deepest of all passes' points, and when; nothing where no catheter entered the brain.
struct Deepest {
  double depth_mm = -1e9, time_s = 0;
};
Deepest deepest(const Scoring& s);

}  // namespace trephine::lessons::detail
