// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "lessons/move_plan.h"

namespace trephine::lessons {

/// A line that the marker draws.
struct TraceStep {
  ScriptPlace from, to;
  double press_mm = 1.5, speed_mm_per_s = 30;
  template <class V>
  static void describe(V& v) {
    using P = TraceStep;
    v.group(&P::from, "from", "Where the line begins.").is_required();
    v.group(&P::to, "to", "Where it ends; between the two it follows the skin.").is_required();
    v.number(&P::press_mm, "press_mm", Range{0, 20}, "How far below the skin the hand aims.");
    v.number(&P::speed_mm_per_s, "speed_mm_per_s", Range{1, 1000}, "How fast.");
  }
};

/// A hole that the burr drills.
struct DrillStep {
  ScriptPlace at{"mark", 0, 0, {0, 0, 0}};
  double hole_diameter_mm = 14, layer_mm = 1, past_mm = 0.5, feed_force_n = 1, speed_mm_per_s = 20;
  template <class V>
  static void describe(V& v) {
    using P = DrillStep;
    v.group(&P::at, "at", "Where; by default the end of the last trace (mark).");
    v.number(&P::hole_diameter_mm, "hole_diameter_mm", Range{0.1, 60}, "Diameter of the hole.");
    v.number(&P::layer_mm, "layer_mm", Range{0.05, 10}, "Depth of each layer of the spiral path.");
    v.number(&P::past_mm, "past_mm", Range{-40, 5}, "How far behind the inner table the path ends.");
    v.number(&P::feed_force_n, "feed_force_n", Range{0, 20}, "Force above which the hand waits before it goes on.");
    v.number(&P::speed_mm_per_s, "speed_mm_per_s", Range{1, 1000}, "How fast.");
  }
};

/// What a script asks of the hand in a head. Throws Error 65, naming the step, for a place that the case does not have,
/// a tool that the lesson does not have, or skin that cannot be felt there.
std::vector<HandMove> plan_head_moves(const LessonScript& script, const ScriptScene& scene, const ScriptAim& aim);

}  // namespace trephine::lessons
