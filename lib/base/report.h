// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "base/params.h"

namespace trephine {

/// What a stage achieved compared with what was asked. It holds figures, in the order in which a person would read them
/// and named with their unit ("triangles_count", "deviation_max_mm", "stopped_by"), and warnings of one line each. The
/// same report goes to the closing table, run.json and case.json, so it holds nothing that differs between equal runs
/// (no time, path or thread count).
struct Report {
  std::vector<std::pair<std::string, ParameterValue>> figures;
  std::vector<std::string> warnings;

  void add(const std::string& name, double v) { figures.emplace_back(name, v); }
  void add(const std::string& name, std::int64_t v) { figures.emplace_back(name, v); }
  void add(const std::string& name, int v) { figures.emplace_back(name, std::int64_t{v}); }
  void add(const std::string& name, std::size_t v) { figures.emplace_back(name, static_cast<std::int64_t>(v)); }
  void add(const std::string& name, bool v) { figures.emplace_back(name, v); }
  void add(const std::string& name, const char* v) { figures.emplace_back(name, std::string(v)); }
  void add(const std::string& name, const std::string& v) { figures.emplace_back(name, v); }
  void warn(const std::string& text) { warnings.push_back(text); }
  const ParameterValue* find(const std::string& name) const {
    for (const auto& f : figures)
      if (f.first == name) return &f.second;
    return nullptr;
  }
};

}  // namespace trephine
