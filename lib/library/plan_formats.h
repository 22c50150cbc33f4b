// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "library/build.h"
#include "library/ninja.h"

namespace trephine::library {

/// The work of a library build for another engine: which jobs, in which order, with which memory. A job is the command
/// `trephine library one LIBRARY.yaml --out LIBRARY NAME`; no word of it is a series' path.
enum class PlanFormat { json, ninja, make };

struct OnePlannedJob {
  std::string name;  ///< "case.TOKEN" or "phantom.NAME"
  std::vector<std::string> after, reasons, command;
  double memory_mb = 0, time_limit_s = 0;
};
/// What is stale. As make_plan it records what it found of the series, so that the jobs need not read them again.
/// Throws what build_library throws before it begins.
std::vector<OnePlannedJob> plan_of_library(const LibraryBuildRequest& request, const Progress& progress);

std::string plan_text(const std::vector<OnePlannedJob>& jobs, PlanFormat format);

/// Does one job of that plan, whatever else works on the library meanwhile; a case only under its lock. A case that is
/// up to date is left alone. Returns how it ended, with the code 0 where there was nothing to do. Throws Error 64 where
/// the library has no such job.
JobResult do_one_of_library(const LibraryBuildRequest& request, const std::string& name);

}  // namespace trephine::library
