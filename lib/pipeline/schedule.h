// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

namespace trephine::pipeline {

struct ScheduledTask {
  double seconds = 0;        ///< 0 or more
  std::vector<int> sources;  ///< tasks that must have ended before; each has a lower number
};

/// How much of the wall clock's time each task takes when `threads` of them run at once, each as soon as it can, in
/// their order: a time in which several run is shared between them. The sum is the time that all take.
std::vector<double> wall_shares_s(const std::vector<ScheduledTask>& tasks, int threads);

}  // namespace trephine::pipeline
