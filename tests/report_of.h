// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// For tests that look at what is printed of an outcome.
#include <utility>

#include "base/result.h"

namespace trephine {

/// The value of an outcome; what is printed of it is added to the report.
template <class T, class R>
T value_of(Report& report, Outcome<T, R> outcome) {
  add(report, printed(outcome));
  return std::move(outcome.value);
}

/// The same of an outcome that has no value: its result.
template <class R>
R result_of(Report& report, Outcome<std::monostate, R> outcome) {
  add(report, printed(outcome));
  return std::move(outcome.result);
}

}  // namespace trephine
