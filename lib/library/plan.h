// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "library/library_config.h"
#include "library/library_state.h"
#include "library/settings.h"

namespace trephine {

/// What one case or phantom needs; rough, from its voxels, or from its last build where that is known.
struct Estimate {
  double memory_mb = 0, disk_mb = 0;
  double cache_mb = 0;  ///< disk, too, but the cache has a limit
};

struct PlannedPhantom {
  std::string name, identity;        ///< identity: SHA-256 of all that it is made of
  std::string series_sha256;         ///< of what was made; empty where it must be made
  std::vector<std::string> reasons;  ///< why it is made; none: it is there
  bool needed = false;               ///< a case that is built needs it
  Estimate estimate;
};

struct PlannedCase {
  LibraryCase entry;
  std::string token;  ///< where planning failed perhaps what entry.origin says
  std::shared_ptr<const CaseSettings> settings;
  std::filesystem::path series;      ///< of the case; a phantom's too
  CaseInputs inputs;                 ///< series empty while its phantom is not made
  std::vector<std::string> reasons;  ///< why it is built; none: it is what it should be
  std::optional<Error> fault;        ///< its series or configuration cannot be used: not built
  std::uint64_t voxels = 0;
  Estimate estimate;
};

struct LibraryPlan {
  std::vector<PlannedPhantom> phantoms;
  std::vector<PlannedCase> cases;  ///< as in the configuration; of found series with equal content the first alone
  int repeated = 0;                ///< found series that were left out for that
};

struct PlanOptions {
  bool rehash = false, rebuild = false, pictures = true;
  std::vector<std::string> only;  ///< tokens; none: all
  std::string program_version;
  bool write = true;  ///< inputs and settings are recorded; false: nothing on disk changes
};

/// Finds what is stale, by content: reads configurations (each once, however many cases share it) and hashes series, or
/// trusts their unchanged files. Faults of a configuration that several cases share are thrown (78, 66); what is wrong
/// with one case is in its `fault`. Throws 64 where `only` names no case; 73, 74; Cancelled.
LibraryPlan make_plan(const LibraryConfig& config, const LibraryState& state, const PlanOptions& options,
                      const Progress& progress);

}  // namespace trephine
