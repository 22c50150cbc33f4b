// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/params.h"
#include "json/job_status.h"
#include "library/plan.h"

namespace trephine::library {

struct LibraryBuildParams {
  int jobs = 0;
  std::int64_t memory_mb = 0;
  bool keep_going = true, rehash = false, rebuild = false, dry_run = false;
  bool pictures = true, sheet = true, check_disk = true, allow_external = false;
  std::int64_t cache_limit_mb = 65536;
  double case_limit_s = 7200;
  Engine engine = Engine::as_configured;
  bool wait = true;

  template <class V>
  static void describe(V& v) {
    using P = LibraryBuildParams;
    v.integer(&P::jobs, "jobs", Range{0, 1024}, "Cases at once, each on one thread; 0: as many as --threads says.");
    v.integer(&P::memory_mb, "memory_mb", Range{0, 1e9},
              "Memory that the cases at work may take together by estimate; 0: 85 % of what is free now.");
    v.flag(&P::keep_going, "keep_going", "After a case that fails, build the others.");
    v.flag(&P::rehash, "rehash", "Read every series again, also where its files look unchanged.");
    v.flag(&P::rebuild, "rebuild", "Build every case, stale or not.");
    v.flag(&P::dry_run, "dry_run", "Say what would be built and why; build nothing and write nothing.");
    v.flag(&P::pictures, "pictures", "Make the pictures and the pages in the cases' report folders.");
    v.flag(&P::sheet, "sheet", "Make the contact sheet, index.html and contact_sheet.png, where a case changed.");
    v.flag(&P::check_disk, "check_disk", "Refuse to begin where the disk is too small by estimate.");
    v.integer(&P::cache_limit_mb, "cache_limit_mb", Range{0, 1e9},
              "What the cache of stages may hold, in MB; the oldest goes first.");
    v.flag(&P::allow_external, "allow_external",
           "Allow the stage external to run the programs that the recipes name, as for `run`.");
    v.number(&P::case_limit_s, "case_limit_s", Range{0, 1e6}, "A case that takes longer is stopped; 0: none is.");
    v.choice(&P::engine, "engine",
             {{"as_configured", Engine::as_configured}, {"ninja", Engine::ninja}, {"slurm", Engine::slurm}},
             "What does the work: Ninja on this machine, or Slurm on a cluster; else as LIBRARY.yaml says.");
    v.flag(&P::wait, "wait",
           "With Slurm, stay until all is done; otherwise submit and leave. `library status` tells how far it is.");
  }
};

struct LibraryBuildRequest {
  std::filesystem::path config, library;
  LibraryOverrides overrides;
  std::vector<std::string> only;  ///< tokens; none: all
  std::vector<std::string> why;   ///< tokens: explain these and build nothing
  LibraryBuildParams params;
  std::string program_version;
};

/// Who watches a build; called from one thread.
class LibraryObserver {
 public:
  virtual ~LibraryObserver() = default;
  virtual void planning(double fraction) = 0;
  virtual void began(int jobs) = 0;
  virtual void started(const std::string& job) = 0;
  /// A few times a second: jobs at work, by name, and how far each is.
  virtual void working(const Named<json::JobStatus>& running, int done, int failed, double seconds_left) = 0;
  virtual void finished(const std::string& job, const JobResult& result) = 0;
};

struct LibraryBuildResult {
  int cases = 0, fresh = 0, built = 0, failed = 0;
  int under_way = 0;  ///< submitted to a cluster and not done yet
  std::string table;  ///< for a person: what was, or would be, done, and every failure with its reason
  std::string json;
  int code = 0;  ///< 0, or that of the first failure in the library's order
};

/// Brings every case of a library up to date: plans by content (library/plan.h), checks the disk (73 where it is too
/// small), and hands what is stale to Ninja, in pools by memory, or to Slurm (library/slurm_build.h). What fails leaves
/// the case's last good state. Only one build works on a library at a time (75). Throws what reading the configuration
/// throws; 73, 74; 70 where Ninja cannot be started; Cancelled.
LibraryBuildResult build_library(const LibraryBuildRequest& request, LibraryObserver& observer);

}  // namespace trephine::library
