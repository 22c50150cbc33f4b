// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/params.h"
#include "pipeline/case_table.h"
#include "pipeline/config.h"
#include "pipeline/executor.h"

namespace trephine {

/// What `trephine run` takes besides files and folders.
struct RunParams {
  std::string case_token;
  bool use_cache = true;
  std::int64_t cache_limit_mb = 8192;
  bool pictures = true;

  template <class V>
  static void describe(V& v) {
    using P = RunParams;
    v.text(&P::case_token, "case",
           "Name of the case: a-z, 0-9, _ and -, never a patient's; overrides the configuration's; random where "
           "neither gives one.");
    v.flag(&P::use_cache, "use_cache",
           "Reuse and keep the outputs of stages whose inputs and parameters are the same.");
    v.integer(&P::cache_limit_mb, "cache_limit_mb", Range{0, 1e9},
              "What the cache may hold after the run, in MB; the oldest goes first.");
    v.flag(&P::pictures, "pictures", "Make the pictures in the case's report folder.");
  }
};

struct RunRequest {
  std::filesystem::path config;
  std::filesystem::path library;  ///< the case becomes <library>/<case>/
  ConfigOverrides overrides;
  RunParams params;
  std::filesystem::path keep;   ///< intermediates of every stage go here as files; empty: not
  std::filesystem::path cache;  ///< empty: <library>/.trephine-cache
  std::string program_version;
};

struct RunResult {
  std::filesystem::path case_folder;
  std::string case_token;
  std::vector<AnatomyResult> anatomies;
  std::vector<std::string> warnings;
  std::string json;   ///< the same as run.json: stages with times and reports, memory, load
  std::string table;  ///< for a person
};

/// Builds one case, idempotently: afterwards the library holds the old case or the new one. Reads the configuration,
/// checks that the library can be written (73) and the face policy (81) before any work, computes what the scene
/// demands, holds the results against the scene's limits (80), and publishes. 75 where another run builds the same
/// case.
RunResult run_case(const RunRequest& request, RunObserver& observer);

}  // namespace trephine
