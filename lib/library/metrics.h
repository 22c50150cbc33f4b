// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "library/batch.h"
#include "library/catalogue.h"

namespace trephine::library {

/// The state of a library in Prometheus' text format (version 0.0.4): cases by state and class, of each case what its
/// last run took and what it became, the seconds of each stage over all cases, and the jobs that a cluster has of it.
/// Labels hold case tokens, anatomies and names of stages, nothing of a patient. The order is fixed.
class LibraryMetrics {
 public:
  void add(const CaseRow& row);
  /// `open`: the batches that a cluster has.
  std::string text(const std::vector<Batch>& open) const;

 private:
  std::map<std::string, int> states_ = {{"published", 0}, {"unreadable", 0}, {"last_build_failed", 0}}, classes_;
  std::map<std::string, std::pair<double, int>> stages_;  // seconds, and in how many runs
  std::vector<std::string> of_cases_;                     // the lines of each figure that a case has
};

}  // namespace trephine::library
