// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/schedule.h"

#include <algorithm>

namespace trephine::pipeline {

std::vector<double> wall_shares_s(const std::vector<ScheduledTask>& tasks, int threads) {
  std::vector<double> share(tasks.size()), left;
  std::vector<char> ended(tasks.size()), runs(tasks.size());
  for (const ScheduledTask& t : tasks) left.push_back(t.seconds);
  const auto ready = [&](std::size_t i) {
    const auto& s = tasks[i].sources;
    return !ended[i] && !runs[i] && std::all_of(s.begin(), s.end(), [&](int source) { return ended[source]; });
  };
  std::vector<std::size_t> running;
  for (std::size_t done = 0; done < tasks.size();) {
    for (std::size_t i = 0; i < tasks.size() && running.size() < std::size_t(std::max(1, threads)); ++i)
      if (ready(i)) {
        runs[i] = 1;
        running.push_back(i);
      }
    const auto first = *std::min_element(running.begin(), running.end(),
                                         [&](std::size_t a, std::size_t b) { return left[a] < left[b]; });
    const double step_s = left[first];
    for (const std::size_t i : running) {
      share[i] += step_s / double(running.size());
      left[i] -= step_s;
    }
    left[first] = 0;
    ended[first] = 1;
    running.erase(std::find(running.begin(), running.end(), first));
    ++done;
  }
  return share;
}

}  // namespace trephine::pipeline
