// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/result.h"

#include "base/error.h"

namespace trephine {

void add_declared_figures(Report& report, const ParameterSet& set, const void* object, const std::string& prefix) {
  for (const Parameter& p : set.parameters) report.figures.emplace_back(prefix + p.name, p.get(object));
}

void read_declared_figures(const Report& report, const ParameterSet& set, void* object, const std::string& prefix) {
  for (const Parameter& p : set.parameters) {
    const ParameterValue* value = report.find(prefix + p.name);
    if (!value) throw Error(ExitCode::internal, "", prefix + p.name, "a stage's report lacks this figure");
    // A whole number that is read back from JSON may stand for a real number.
    if (const auto* whole = std::get_if<std::int64_t>(value); whole && p.kind == ParameterKind::number)
      p.set(object, static_cast<double>(*whole));
    else if (value->index() == p.get(object).index())
      p.set(object, *value);
    else
      throw Error(ExitCode::internal, "", prefix + p.name, "a stage's report has this figure with another type");
  }
}

double number_of(const Report& report, const std::string& name) {
  const ParameterValue* value = report.find(name);
  if (const auto* number = value ? std::get_if<double>(value) : nullptr) return *number;
  if (const auto* whole = value ? std::get_if<std::int64_t>(value) : nullptr) return static_cast<double>(*whole);
  throw Error(ExitCode::internal, "", name, "a stage's report lacks this number");
}

}  // namespace trephine
