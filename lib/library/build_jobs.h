// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <map>
#include <string>
#include <vector>

#include "library/build.h"
#include "library/ninja.h"
#include "library/plan.h"

namespace trephine::library {

/// The folder of the library that holds the stages' cache, which all its cases share.
constexpr const char* library_cache_name = ".trephine-cache";

struct BuildJobs {
  std::vector<NinjaJob> jobs;             ///< as Ninja should take those that are ready
  std::map<std::string, double> weights;  ///< by job: how long it takes beside the others, about
};

/// The commands that make what is stale in the plan: each case that has reasons and no fault, and before its cases each
/// phantom whose series they lack. Cases of one series follow each other. Reads and writes nothing.
BuildJobs make_build_jobs(const LibraryPlan& plan, const LibraryConfig& config, const LibraryState& state,
                          const LibraryBuildParams& params);

}  // namespace trephine::library
