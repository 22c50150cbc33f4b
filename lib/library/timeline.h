// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <map>
#include <string>
#include <vector>

#include "library/batch.h"
#include "library/library_state.h"

namespace trephine::library {

/// When a job of the last build ran, and where. Times are seconds since the epoch by the clock of whoever ran it.
struct TimelineItem {
  std::string name, node;
  double begin_s = 0, end_s = 0, cpu_s = 0;
  int code = 0;
};

/// Keeps the last build's times in LIBRARY/.library/timeline.json. That it cannot is a warning.
void keep_timeline(const LibraryState& state, const std::vector<TimelineItem>& items);
/// Of the jobs of a batch that began and ended.
std::vector<TimelineItem> timeline_of(const Batch& batch);
/// Throws Error 66 where no build kept any.
std::vector<TimelineItem> read_timeline(const LibraryState& state);

/// The stages of a case's last run that were computed, with their seconds, by the case's token.
using StagesOfCases = std::map<std::string, std::vector<std::pair<std::string, double>>>;

/// A picture (SVG): a lane for each place on each node, a bar for each job from its beginning to its end, parted by the
/// stages in which its time went, and below what each stage took of all. The same items give the same bytes.
std::string timeline_svg(std::vector<TimelineItem> items, const StagesOfCases& stages);

}  // namespace trephine::library
