// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "haptics/recording.h"

namespace trephine::session {

struct Patient;

/// A target that runs over the surface, for a hand to follow [Rizzi, 4.5.1 and figure 10]: along the circle of a
/// simulated hand (device/hand_path.h), at constant speed, again and again.
class MovingTarget {
 public:
  /// On the volume as it is now. Throws as device::path_over does.
  MovingTarget(const haptics::TargetParams& params, const contact::ContactVolume& contact,
               const contact::TouchableFaces& faces);
  /// Where it is at that time of the session; before its begin, at the first place.
  Vec3 at_mm(double time_s) const { return place_mm(way_mm(time_s)); }
  Vec3 first_mm() const { return path_mm_.front(); }
  double round_mm() const { return along_mm_.back(); }  ///< once around
  bool runs(double time_s) const { return time_s >= begins_s_; }
  double speed_mm_per_s() const { return speed_mm_per_s_; }
  /// How far a tip is behind along the path, from its place there that is nearest to the tip: negative where it is
  /// ahead, at most half a round.
  double behind_mm(double time_s, Vec3 tip_mm) const;

 private:
  double way_mm(double time_s) const;
  Vec3 place_mm(double way_mm) const;
  double speed_mm_per_s_, begins_s_;
  std::vector<Vec3> path_mm_;     // closed: the last place is the first
  std::vector<double> along_mm_;  // from the first
};
/// The target of a recording or a session; null where it has none.
std::shared_ptr<const MovingTarget> target_of(const haptics::RecordingHeader& header, const Patient& patient);

/// How a tip followed it, while it ran.
struct TargetFigures {
  double seconds = 0;
  double mean_off_mm = 0, p95_off_mm = 0, most_off_mm = 0;  ///< from the target, in any direction
  double mean_behind_mm = 0, p95_behind_mm = 0;             ///< along the path
  double mean_behind_s = 0;                                 ///< at the target's speed
  double touching_ratio = 0;                                ///< of the time
};
/// Takes the frames of a session or a recording as they come; of the tip as it is shown, 100 times a second.
class TargetWatch {
 public:
  explicit TargetWatch(std::shared_ptr<const MovingTarget> target) : target_(std::move(target)) {}
  void look(const haptics::ServoFrame& frame);
  TargetFigures figures() const;
  const MovingTarget& target() const { return *target_; }

 private:
  std::shared_ptr<const MovingTarget> target_;
  std::vector<double> off_mm_, behind_mm_;
  double next_s_ = 0, seconds_ = 0, touching_s_ = 0;
};
/// "followed for 12.0 s: ..." in a line; empty where the target did not run.
std::string target_text(const TargetFigures& figures);

}  // namespace trephine::session
