// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "config/said.h"

namespace trephine::library {

/// What does the work of a library build.
enum class Engine { as_configured, ninja, slurm };

/// A class of cases by the memory that they need: a case goes into the first class that has enough.
struct EngineClassParams {
  std::int64_t memory_mb = 4096;
  double time_limit_s = 7200;
  std::string partition;
  template <class V>
  static void describe(V& v) {
    using P = EngineClassParams;
    v.integer(&P::memory_mb, "memory_mb", Range{1, 1e9}, "Memory that Slurm grants a case of the class.").is_required();
    v.number(&P::time_limit_s, "time_limit_s", Range{1, 1e7}, "A case of the class that takes longer is stopped.");
    v.text(&P::partition, "partition", "The class's own partition, instead of the engine's.");
  }
};

/// `engine:` of LIBRARY.yaml (docs/how-to/cluster.md).
struct EngineParams {
  Engine name = Engine::ninja;
  std::string partition, account;
  std::vector<config::SaidValue> sbatch;
  std::vector<EngineClassParams> classes;
  std::int64_t max_array_count = 0, at_once_count = 0, resubmissions_count = 3;
  double lease_s = 120;
  template <class V>
  static void describe(V& v) {
    using P = EngineParams;
    v.choice(&P::name, "name", {{"ninja", Engine::ninja}, {"slurm", Engine::slurm}},
             "What does the work: Ninja on this machine, or Slurm on a cluster. --engine overrides it.");
    v.text(&P::partition, "partition", "Slurm's partition; none: the cluster's default.");
    v.text(&P::account, "account", "The account that Slurm charges; none: the user's default.");
    v.list(&P::sbatch, "sbatch", "Further options of sbatch, each as one word: --qos=low.");
    v.list(&P::classes, "classes", "Classes of cases by memory; none: powers of two of 256 MB, and --case-limit-s.");
    v.integer(&P::max_array_count, "max_array_count", Range{0, 1e6},
              "Most tasks of one job array; 0: the cluster's MaxArraySize, at most 1000.");
    v.integer(&P::at_once_count, "at_once_count", Range{0, 1e6},
              "Most tasks of one job array at once; 0: as many as Slurm starts.");
    v.integer(
        &P::resubmissions_count, "resubmissions_count", Range{0, 100},
        "How often a case is submitted again whose node died, that was killed, that met a full disk, or that needs the "
        "next class.");
    v.number(
        &P::lease_s, "lease_s", Range{5, 3600},
        "Seconds after which a lock is taken over that its holder does not renew; above the attribute cache of NFS.");
  }
};

}  // namespace trephine::library
