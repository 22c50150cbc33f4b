// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "base/params.h"
#include "base/progress.h"

namespace trephine::library {

struct VerifyResult {
  int cases = 0;
  std::uint64_t files = 0, bytes = 0;
  std::vector<std::pair<std::string, std::string>> faults;  ///< case, what is wrong with it
  std::string table;
};

/// Reads every byte of every case (or of the named cases) and compares it with the checksums of case.json; with `load`,
/// every case is also loaded as the simulator would load it (cases/load_case.h). A case that is published again
/// meanwhile is read again. Throws Error 66 where there is no library or no such case; Cancelled.
VerifyResult verify_library(const std::filesystem::path& library, const std::vector<std::string>& only, bool load,
                            const Progress& progress);

struct GcParams {
  bool dry_run = false;
  double cache_days = 30;
  std::int64_t cache_limit_mb = 65536;

  template <class V>
  static void describe(V& v) {
    using P = GcParams;
    v.flag(&P::dry_run, "dry_run", "Say what would be removed and remove nothing.");
    v.number(&P::cache_days, "cache_days", Range{0, 1e6},
             "Outputs of stages that no run has used for this many days are removed.");
    v.integer(&P::cache_limit_mb, "cache_limit_mb", Range{0, 1e9},
              "Largest size of the cache afterwards, in MB; the oldest entries go first.");
  }
};

struct GcResult {
  int case_files = 0, folders = 0, cache_entries = 0, records = 0, batches = 0, temporaries = 0;
  int drops = 0, drafts = 0;  ///< of the desk: scans that nobody uses, and what it kept of cases that are gone
  int busy = 0;               ///< cases that another run is building; they are left alone
  std::uint64_t bytes = 0;
  std::string table;
};

/// Removes what refused runs kept for looking, and what nothing refers to: files of a case that its case.json does not
/// name, remains of killed runs (temporary files, and case folders in which nothing was published and that no run works
/// on), stale and torn entries of the cache, records of cases that are gone, and what batches of Slurm left that ended,
/// or whose submission was broken off, an hour ago or more; and what the desk kept of cases that are gone. Where
/// `library_file`, its LIBRARY.yaml, is given, also scans that were dropped on the desk an hour ago or more and that it
/// does not use (dropped.h), and texts that a killed desk left beside it. A case whose case.json is damaged is left as
/// it is. It is safe beside running builds, because a case's files are touched only under its lock. Throws Error 66;
/// Cancelled.
GcResult collect_garbage(const std::filesystem::path& library, const GcParams& params, const Progress& progress,
                         const std::filesystem::path& library_file = {});

}  // namespace trephine::library
