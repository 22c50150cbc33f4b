// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <vector>

#include "outcome/bone_fit.h"
#include "outcome/case_spine.h"

namespace trephine::outcome {

/// A case's vertebrae laid on a scan, each by its own bone, for they move against each other.
struct SpineFit {
  BoneFit all;                                 ///< of all bone as one rigid piece
  std::vector<BoneFit> of_level;               ///< by level; overlap_ratio 0 where it does not lie in the scan
  std::vector<std::vector<BonePoint>> points;  ///< by level
  /// Root mean square of the vertebrae's residuals, and the share of their bone that lies in the scan.
  double residual_mm = 1e9, overlap_ratio = 0, matched_ratio = 0;
  std::size_t points_count = 0;
  double next_level_residual_mm = 1e9;  ///< the same with the vertebrae shifted by a level or more, the best of these
  double mirrored_residual_mm = 1e9;    ///< and of the mirrored case
  bool is_seen(std::size_t level) const { return of_level[level].overlap_ratio >= least_seen; }
  static constexpr double least_seen = 0.5;
};

/// Lays all bone first, then vertebra after vertebra from the middle outwards, each from where its neighbour lies; and
/// tries each shift along the spine by whole levels, for vertebrae look alike: the best is taken, and how much worse
/// the next one lies is noted. Nothing where too little bone lies in the scan. Cancelled.
std::optional<SpineFit> fit_vertebrae(const CaseSpine& spine, const ScanView& scan, const Progress& progress = {});

}  // namespace trephine::outcome
