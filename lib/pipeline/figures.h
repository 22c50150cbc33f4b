// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "base/report.h"

namespace trephine {

/// A report's figure as a number; 0 where it is not there.
inline double number_in(const Report& report, const std::string& name) {
  const ParameterValue* v = report.find(name);
  if (!v) return 0;
  if (const auto* d = std::get_if<double>(v)) return *d;
  if (const auto* i = std::get_if<std::int64_t>(v)) return static_cast<double>(*i);
  return 0;
}

}  // namespace trephine
