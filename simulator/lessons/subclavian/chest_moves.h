// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "lessons/move_plan.h"

namespace trephine::lessons {

/// A place in a chest: notch, vein_right, vein_left (chest_frame.h), a landmark or target of the case; then by an
/// offset; then, where it is to be on the skin, straight forwards to it.
struct ChestPlace {
  std::string at;
  std::array<double, 3> offset_mm{0, 0, 0};
  bool on_skin = false;
  template <class V>
  static void describe(V& v) {
    using P = ChestPlace;
    v.text(&P::at, "at", "notch, vein_right, vein_left, or a landmark or target of the case.").is_required();
    v.numbers(&P::offset_mm, "offset_mm", Range{-300, 300}, "From there by so much, LPS.");
    v.flag(&P::on_skin, "on_skin", "Then straight forwards to the skin.");
  }
};

struct PunctureStep {
  ChestPlace from, toward;
  double short_of_mm = 0, speed_mm_per_s = 15;
  template <class V>
  static void describe(V& v) {
    using P = PunctureStep;
    v.group(&P::from, "from", "Where the needle enters the skin.").is_required();
    v.group(&P::toward, "toward", "The place that its line goes to.").is_required();
    v.number(&P::short_of_mm, "short_of_mm", Range{-150, 150}, "How far before that place it stops.");
    v.number(&P::speed_mm_per_s, "speed_mm_per_s", Range{1, 1000}, "How fast.");
  }
};

/// What a script asks of the hand in a chest. Throws Error 65, naming the step.
std::vector<HandMove> plan_chest_moves(const LessonScript& script, const ScriptScene& scene, const ScriptAim& aim);

}  // namespace trephine::lessons
