// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/pose_source.h"

#include <fmt/format.h>

#include <chrono>
#include <thread>

namespace trephine::track {

Error no_pose(const TrackerLink& link, const std::string& body, const std::string& reference, const WatchCounts& counts,
              const std::vector<std::string>& strangers) {
  std::string why, all;
  for (const std::string& name : strangers) all += (all.empty() ? "" : ", ") + name;
  if (link.foreign_version() != 0)
    why = fmt::format("the server sends version {} of OpenIGTLink, or none; set it to 1 or 2", link.foreign_version());
  else if (link.connections() == 0)
    why = "nobody answers; start the tracker's server, and give its computer by tracker_host and tracker_port";
  else if (counts.mirrored > 0)
    why = "its poses are mirrored; set the server to a right-handed frame";
  else if (counts.not_rigid > 0)
    why = "its poses are no rotations; set the server to send rigid transforms in mm";
  else if (counts.incomplete > 0)
    why = "it sends the place of the body alone; a body that shows how it is turned is needed";
  else if (counts.broken > 0)
    why = "its messages are broken: a check sum or a size is wrong";
  else if (counts.unseen > 0)
    why = "it sends the identity, as of a body that is out of view; bring it into view";
  else if (counts.late > 0)
    why = "its poses come late; set `tracker_late_ms`, or mend the network";
  else if (!all.empty())
    why = "it sends other bodies: " + all;
  else
    why = "it sends nothing; start the tracking, or use `tracker_ask`";
  return {ExitCode::no_input, "", "tracker",
          fmt::format("no pose of {}{} came from {}: {}", body, reference.empty() ? "" : " before " + reference,
                      link.endpoint(), why)};
}

PoseSource::PoseSource(const TrackerParams& params, const std::vector<std::string>& tools, const std::string& reference)
    : params_(params),
      tools_(tools),
      reference_(reference),
      poses_(tools.size()),
      watch_({tools, reference, 1e-3 * params.tracker_late_ms},
             [this](int tool, const RigidMap& map, double) { poses_[std::size_t(tool)].push_back(map); }),
      link_(
          params,
          [this](const IgtlHeader& header, const IgtlContent& content) {
            const std::scoped_lock lock(mutex_);
            watch_.take(header, content, steady_s());
          },
          [this] {
            const std::scoped_lock lock(mutex_);
            watch_.begin_anew();
          }) {}

std::vector<RigidMap> PoseSource::take(int tool, std::size_t count, const Progress& progress) {
  std::vector<RigidMap> out;
  {
    const std::scoped_lock lock(mutex_);
    poses_[std::size_t(tool)].clear();
  }
  double since_s = steady_s();
  while (out.size() < count) {
    progress.check();
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    const std::scoped_lock lock(mutex_);
    std::vector<RigidMap>& come = poses_[std::size_t(tool)];
    if (!come.empty()) since_s = steady_s();
    out.insert(out.end(), come.begin(), come.end());
    come.clear();
    if (steady_s() - since_s > params_.tracker_wait_s)
      throw no_pose(link_, tools_[std::size_t(tool)], reference_, watch_.counts(), watch_.strangers());
  }
  out.resize(count);
  return out;
}

}  // namespace trephine::track
