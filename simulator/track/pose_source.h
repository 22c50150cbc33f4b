// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mutex>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/progress.h"
#include "track/body_watch.h"
#include "track/tracker_link.h"

namespace trephine::track {

/// Why no pose of a body came, as Error 66 with what to do.
Error no_pose(const TrackerLink& link, const std::string& body, const std::string& reference, const WatchCounts& counts,
              const std::vector<std::string>& strangers);

/// Poses of tools before a reference, taken from a tracker one after the other, for calibrations.
class PoseSource {
 public:
  PoseSource(const TrackerParams& params, const std::vector<std::string>& tools, const std::string& reference);
  /// That many poses of the tool which come from now on. Throws Error 66 where none comes for tracker_wait_s,
  /// Cancelled.
  std::vector<RigidMap> take(int tool, std::size_t count, const Progress& progress);

 private:
  const TrackerParams params_;
  const std::vector<std::string> tools_;
  const std::string reference_;
  std::mutex mutex_;  // of what follows
  std::vector<std::vector<RigidMap>> poses_;
  BodyWatch watch_;
  TrackerLink link_;  // ends first
};

}  // namespace trephine::track
