// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace trephine::publish {

/// What the pipeline made of one anatomy, as [Rizzi, chapter 2, Table I] reports it.
struct AnatomyResult {
  std::string name;
  std::int64_t triangles_before = 0, triangles_after = 0;
  std::uint64_t bytes_before = 0, bytes_after = 0;                          ///< as GLB, before and after decimation
  double deviation_max_mm = 0, deviation_p99_mm = 0, deviation_rms_mm = 0;  ///< two-sided, to the unreduced surface
  double volume_ml = 0;
  double seconds = 0;  ///< of all stages of this anatomy alone
  std::string stopped_by;
};

/// A table with aligned columns for a person. Numbers are the same whatever the locale.
std::string case_table(const std::vector<AnatomyResult>& anatomies);

}  // namespace trephine::publish
