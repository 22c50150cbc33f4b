// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "base/params.h"
#include "base/report.h"
#include "base/warning.h"

namespace trephine {

/// Results are declared structs, as parameters are (base/params.h): code reads their members, and what is printed,
/// written or kept is made of the declaration.

/// What a function made, what it measured of it, and what it warns of.
template <class T, class R>
struct Outcome {
  T value;
  R result;
  Warnings warnings;
};

/// The printed names and values of a result, in the order of its declaration. What belongs to a group or to an item of
/// a map has its name and a dot before it, what belongs to an item of a list its number from 1; where the declaration
/// says `items_alone`, no name of the list or map stands before that. A value that is not there is left out.
Named<ParameterValue> figures_of(const ParameterSet& set, const void* result);
inline Named<ParameterValue> figures_of(const AnyParams& result) {
  return figures_of(*result.set, result.object.get());
}
template <class R>
Named<ParameterValue> figures_of(const R& result) {
  return figures_of(parameters_of<R>(), &result);
}

/// A result and its warnings as they are printed.
Report printed(Named<ParameterValue> figures, const Warnings& warnings);
inline Report printed(const AnyParams& result, const Warnings& warnings) {
  return printed(figures_of(result), warnings);
}
template <class T, class R>
Report printed(const Outcome<T, R>& outcome) {
  return printed(figures_of(outcome.result), outcome.warnings);
}

namespace detail {
[[noreturn]] void refuse_result(const ParameterSet* is, const ParameterSet& wanted);
}  // namespace detail

/// Prints one report behind the other.
inline void add(Report& report, const Report& more) {
  report.figures.insert(report.figures.end(), more.figures.begin(), more.figures.end());
  report.warnings.insert(report.warnings.end(), more.warnings.begin(), more.warnings.end());
}

/// The result, where it is such a struct; else null.
template <class R>
const R* result_if(const AnyParams& any) {
  return any.set == &parameters_of<R>() ? &any.as<R>() : nullptr;
}

/// The result as the struct that it is. Throws Error 70 where it is another one.
template <class R>
const R& result_as(const AnyParams& any) {
  if (any.set != &parameters_of<R>()) detail::refuse_result(any.set, parameters_of<R>());
  return any.as<R>();
}

}  // namespace trephine
