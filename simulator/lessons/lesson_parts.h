// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What several lessons say alike of their facts and columns.
#include "lessons/lesson_type.h"

namespace trephine::lessons {

/// Whether an instrument that was passed into the patient has not been drawn out again; of facts, the last one.
template <class Pass>
bool is_still_in(const Pass& pass, const LessonFacts& facts) {
  return pass.in_place || pass.end_s >= facts.end_s;
}
template <class Facts>
bool is_still_in(const Facts& facts) {
  return !facts.passes.empty() && is_still_in(facts.passes.back(), facts);
}

/// The column of a figure which a row is judged by.
inline LessonColumn measured_for(const std::string& row, const std::string& name) {
  return {name, "measured for the row " + row, row};
}

}  // namespace trephine::lessons
