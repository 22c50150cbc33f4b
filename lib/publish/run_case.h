// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/params.h"
#include "config/config.h"
#include "pipeline/executor.h"
#include "publish/case_table.h"
#include "publish/explain.h"
#include "stages/warning_kind.h"

namespace trephine::publish {

/// How much of a case is drawn; `full`: each surface from six sides too (trephine pictures makes those later).
enum class DrawnReport { brief, full };

/// The parameters of `trephine run`, without its files and folders.
struct RunParams {
  std::string case_token;
  std::string profile;
  bool use_cache = true;
  std::int64_t cache_limit_mb = 8192;
  DrawnReport report = DrawnReport::brief;
  bool pictures = true, page = true, check_disk = true, allow_external = false;

  template <class V>
  static void describe(V& v) {
    using P = RunParams;
    v.text(&P::case_token, "case",
           "Name of the case: a-z, 0-9, _ and -; never a patient's name. It overrides the configuration's; where "
           "neither gives one, it is random.");
    v.word(&P::profile, "profile", config::profile_names,
           "A named point of the trade that the configuration names, instead of the configuration's own rule.");
    v.flag(&P::use_cache, "use_cache",
           "Reuse and keep the outputs of stages whose inputs and parameters are the same.");
    v.integer(&P::cache_limit_mb, "cache_limit_mb", Range{0, 1e9},
              "Largest size of the cache after the run, in MB; the entries used longest ago go first.");
    v.flag(&P::pictures, "pictures", "Make the pictures in the case's report folder.");
    v.choice(&P::report, "report", {{"brief", DrawnReport::brief}, {"full", DrawnReport::full}},
             "brief: the overview, slices with outlines, landmarks and whatever a warning names; full: each surface "
             "from six sides too. trephine pictures makes those later.");
    v.flag(&P::page, "page",
           "Make the case's page, report/view.html, which shows it in a browser; trephine page makes it later.");
    v.flag(&P::check_disk, "check_disk",
           "Refuse to go on, once the scan has been read, where the disk is too small for its case by estimate.");
    v.flag(&P::allow_external, "allow_external",
           "Allow the stage external to run the programs that the recipe names. They run as you, with limits; say it "
           "only where you trust the recipe.");
  }
};

struct RunRequest {
  std::filesystem::path config;
  std::filesystem::path library;  ///< the case becomes <library>/<case>/
  config::ConfigOverrides overrides;
  RunParams params;
  std::filesystem::path keep;   ///< the output of every stage is written here too; empty: not written
  std::filesystem::path cache;  ///< empty: <library>/.trephine-cache
  std::filesystem::path json;   ///< where the caller will write RunResult::json; empty: nowhere
  std::string program_version;
};

struct RunResult {
  std::filesystem::path case_folder;
  std::string case_token;
  std::vector<AnatomyResult> anatomies;
  std::vector<stages::GradedWarning> warnings;  ///< logged already, the gravest first
  std::string json;                             ///< the same as run.json: stages with times and reports, memory, load
  std::string table;                            ///< for a person
};

/// What follows the last node, as an observer names it: pictures, page and publishing.
constexpr const char* publishing_step = "publish";

/// Builds one case, idempotently: afterwards the library holds the old case or the new one. Before any work it reads
/// the configuration, refuses outputs inside the case's folder (64), checks the face policy (81), makes and checks the
/// folders (73) and takes the case's lock (75 where another run builds the same case). Then it reads the scan and,
/// where the disk is too small for its case by estimate, ends (73); else it computes what the scene demands, logs the
/// warnings of every stage, checks the results against the scene's limits (80), and publishes. What a refused run (80,
/// 81) has made is kept for looking beside the case (publish/refused.h). Pictures of the previous run and files that
/// case.json no longer names are removed afterwards: a program that is still reading the older case may get Error 66
/// for such a file, and should read case.json again.
RunResult run_case(const RunRequest& request, pipeline::RunObserver& observer);

/// Says what run_case would compute, what it would take from its cache, what it would skip, and why. Reads the
/// configuration and the series, but computes and writes nothing; the library need not exist.
Explanation explain_case(const RunRequest& request);

}  // namespace trephine::publish
