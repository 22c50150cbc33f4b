// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "library/job.h"

namespace trephine {

struct NinjaJob {
  LibraryJob job;
  std::vector<std::string> after;  ///< names of jobs that end first
  double memory_mb = 0;
};

/// The pools that keep the jobs within a budget: jobs are classed by memory (powers of two of 256 MB), and each class
/// gets so many places that no choice of `jobs` jobs exceeds it. `jobs` may have to be smaller than asked for.
struct MemoryPools {
  int jobs = 1;
  std::vector<double> class_mb;  ///< ascending: the most a job of the class takes
  std::vector<int> places;
  std::size_t class_of(double memory_mb) const;
};
MemoryPools make_pools(const std::vector<double>& memory_mb, double budget_mb, int jobs);

/// The build file.
std::string ninja_file(const std::vector<NinjaJob>& jobs, const MemoryPools& pools, const std::string& program);

struct NinjaOptions {
  std::filesystem::path folder;  ///< where it runs, the file and its log lie
  bool keep_going = true;
  double tick_s = 0.2;
};

/// Runs all jobs; `event` for each that starts or ends, `tick` in between. Throws 70 where Ninja cannot be started or
/// fails by itself, 73 and 74; Cancelled after all jobs ended.
void run_ninja(const std::vector<NinjaJob>& jobs, const MemoryPools& pools, const NinjaOptions& options,
               const std::function<void(const JobEvent&)>& event, const std::function<void()>& tick);

}  // namespace trephine
