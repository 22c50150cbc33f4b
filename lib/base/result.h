// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "base/params.h"
#include "base/report.h"

namespace trephine {

/// Adds a struct of figures, which are declared as parameters are (base/params.h), to a report. They are printed, kept
/// in a cache and read back under the declared names with `prefix` before each.
void add_declared_figures(Report& report, const ParameterSet& set, const void* object, const std::string& prefix);

/// Reads the figures back into the object. Throws Error 70, naming the figure, where one is missing or has another
/// type.
void read_declared_figures(const Report& report, const ParameterSet& set, void* object, const std::string& prefix);

/// Reads one number. Throws Error 70 where the figure is missing or is not a number.
double number_of(const Report& report, const std::string& name);

template <class R>
void add_result(Report& report, const R& result, const std::string& prefix = "") {
  add_declared_figures(report, parameters_of<R>(), &result, prefix);
}

template <class R>
R result_of(const Report& report, const std::string& prefix = "") {
  R result;
  read_declared_figures(report, parameters_of<R>(), &result, prefix);
  return result;
}

}  // namespace trephine
