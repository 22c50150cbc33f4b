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
#include "publish/case_needs.h"

namespace trephine::library {

struct PlannedPhantom {
  std::string name, identity;        ///< identity: SHA-256 of everything that it is made of
  std::string series_sha256;         ///< of the series that was made; empty where it must be made
  std::vector<std::string> reasons;  ///< why it must be made; empty: it exists
  bool needed = false;               ///< a case that will be built needs it
  publish::CaseNeeds estimate;
};

struct PlannedCase {
  LibraryCase entry;
  std::string token;  ///< where planning failed, entry.origin may have to stand for it
  std::shared_ptr<const CaseSettings> settings;
  std::filesystem::path series;      ///< of the case, also if it is a phantom's
  CaseInputs inputs;                 ///< without a series hash as long as its phantom is not made
  std::vector<std::string> reasons;  ///< why it must be built; empty: it is up to date
  std::optional<Error> fault;        ///< its series or configuration cannot be used, so it is not built
  std::uint64_t voxels = 0;
  publish::CaseNeeds estimate;
};

struct LibraryPlan {
  std::vector<PlannedPhantom> phantoms;
  std::vector<PlannedCase> cases;  ///< as in the configuration; of found series with equal content only the first
  int repeated = 0;                ///< how many found series were left out for that reason
};

struct PlanOptions {
  bool rehash = false, rebuild = false, pictures = true;
  std::vector<std::string> only;  ///< tokens of the wanted cases; empty: all
  std::string program_version;
  bool write = true;  ///< record inputs and settings; false: nothing on disk changes
};

/// Finds by content which cases are stale. It reads configurations (each once, however many cases share it) and hashes
/// series, or trusts the record where their files are unchanged. Faults of a configuration that several cases share are
/// thrown (78, 66); a fault of one case is kept in its `fault`. Throws Error 64 where `only` names no case; 73, 74;
/// Cancelled.
LibraryPlan make_plan(const LibraryConfig& config, const LibraryState& state, const PlanOptions& options,
                      const Progress& progress);

}  // namespace trephine::library
