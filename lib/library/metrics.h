// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "library/batch.h"
#include "library/catalogue.h"

namespace trephine::library {

/// The state of a library in Prometheus' text format (version 0.0.4): cases by state and class, of each case what its
/// last run took and what it became, the seconds of each stage over all cases, and the jobs that a cluster has of it.
/// Labels hold case tokens, anatomies and names of stages, nothing of a patient. The order is fixed.
std::string library_metrics(const std::vector<CaseRow>& rows, const std::vector<Batch>& open);

}  // namespace trephine::library
