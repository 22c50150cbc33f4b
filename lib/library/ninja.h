// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "library/job.h"

namespace trephine::library {

struct NinjaJob {
  LibraryJob job;
  std::vector<std::string> after;  ///< names of jobs that must end first
  double memory_mb = 0;
};

/// The pools that keep the jobs within a memory budget. Jobs are classed by memory (powers of two of 256 MB), and each
/// class gets so many places that no choice of `jobs` jobs exceeds the budget. `jobs` may have to be smaller than
/// requested.
struct MemoryPools {
  int jobs = 1;
  std::vector<double> class_mb;  ///< ascending: the largest memory of a job of the class
  std::vector<int> places;
  std::size_t class_of(double memory_mb) const;
};
MemoryPools make_pools(const std::vector<double>& memory_mb, double budget_mb, int jobs);

/// The text of the build file.
std::string ninja_file(const std::vector<NinjaJob>& jobs, const MemoryPools& pools, const std::string& program);

struct NinjaOptions {
  std::filesystem::path folder;  ///< working folder, which holds the file and its log
  bool keep_going = true;
  double tick_s = 0.2;
};

/// Runs all jobs. Calls `event` for each job that starts or ends, and `tick` in between. Throws Error 70 where Ninja
/// cannot be started or fails by itself, 73 and 74; Cancelled after all jobs have ended.
void run_ninja(const std::vector<NinjaJob>& jobs, const MemoryPools& pools, const NinjaOptions& options,
               const std::function<void(const JobEvent&)>& event, const std::function<void()>& tick);

}  // namespace trephine::library
