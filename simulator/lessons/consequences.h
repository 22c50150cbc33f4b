// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <limits>
#include <optional>
#include <vector>

#include "lesson/rubric.h"
#include "lessons/score.h"

namespace trephine::lessons {

/// What flows since a critical error, as its rule says (lesson::CriticalRule::leads_to), in the recording's seconds.
struct Flow {
  lesson::Fluid fluid = lesson::Fluid::none;
  double ml_per_min = 0;
  SeenAt seen;
  double begin_s = 0, end_s = std::numeric_limits<double>::infinity();
  bool runs(double time_s) const { return time_s >= begin_s && time_s < end_s; }
};

/// Of all critical errors of a score that lead to something, in the score's order. It ends when the question that
/// follows the error is rightly answered. A look alone: no row depends on it.
std::vector<Flow> flows_of(const LessonScore& score);

}  // namespace trephine::lessons
