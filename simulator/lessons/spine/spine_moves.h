// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "lessons/move_plan.h"

namespace trephine::lessons {

/// X-rays on for a moment, with the needle where it is.
struct ShootStep {
  double seconds = 0.4;
  template <class V>
  static void describe(V& v) {
    v.number(&ShootStep::seconds, "seconds", Range{0.01, 600}, "How long the pedal is down.");
  }
};

/// The needle's way to a pedicle: on the line through two places, from outside the patient.
struct NeedleStep {
  std::string pedicle;
  double entry_aside_mm = 0, entry_up_mm = 0, target_aside_mm = 0, target_up_mm = 0, short_of_mm = 0,
         speed_mm_per_s = 15;
  template <class V>
  static void describe(V& v) {
    using P = NeedleStep;
    v.text(&P::pedicle, "pedicle", "Which: pedicle_1_left.").is_required();
    v.number(&P::entry_aside_mm, "entry_aside_mm", Range{-60, 60}, "How far it misses the entry, to the outer side.");
    v.number(&P::entry_up_mm, "entry_up_mm", Range{-60, 60}, "And towards the head.");
    v.number(&P::target_aside_mm, "target_aside_mm", Range{-60, 60}, "The same of the target, to the outer side.");
    v.number(&P::target_up_mm, "target_up_mm", Range{-60, 60}, "And towards the head.");
    v.number(&P::short_of_mm, "short_of_mm", Range{-80, 150}, "How far before that place it stops.");
    v.number(&P::speed_mm_per_s, "speed_mm_per_s", Range{1, 1000}, "How fast.");
  }
};

/// On along the needle, after a look.
struct PushStep {
  double by_mm = 10, speed_mm_per_s = 15;
  template <class V>
  static void describe(V& v) {
    using P = PushStep;
    v.number(&P::by_mm, "by_mm", Range{-150, 150}, "How far, along the needle.");
    v.number(&P::speed_mm_per_s, "speed_mm_per_s", Range{1, 1000}, "How fast.");
  }
};

/// What a script asks of the hand behind a spine. Throws Error 65, naming the step, for a pedicle or place that the
/// case does not have.
std::vector<HandMove> plan_spine_moves(const LessonScript& script, const ScriptScene& scene, const ScriptAim& aim);

}  // namespace trephine::lessons
