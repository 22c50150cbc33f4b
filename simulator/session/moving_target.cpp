// SPDX-License-Identifier: GPL-3.0-or-later
#include "session/moving_target.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/rank.h"
#include "device/hand_path.h"
#include "session/session.h"

namespace trephine::session {
namespace {

constexpr double looks_per_s = 100;

double at_share(std::vector<double> values, double share) {
  return values.empty() ? 0 : value_at_rank(values, std::size_t(share * double(values.size() - 1)));
}

}  // namespace

MovingTarget::MovingTarget(const haptics::TargetParams& params, const contact::ContactVolume& contact,
                           const contact::TouchableFaces& faces)
    : speed_mm_per_s_(params.target_speed_mm_per_s), begins_s_(params.target_begins_s) {
  device::HandPathParams circle;
  circle.from = params.target_from;
  circle.radius_mm = params.target_radius_mm;
  circle.depth_mm = circle.approach_mm = 0;
  const device::HandPath path = device::path_over(contact, faces, circle);
  path_mm_.assign(path.points_mm.begin() + std::ptrdiff_t(path.loop_from), path.points_mm.end());
  if (norm(path_mm_.back() - path_mm_.front()) > 0) path_mm_.push_back(path_mm_.front());
  along_mm_.push_back(0);
  for (std::size_t n = 1; n < path_mm_.size(); ++n)
    along_mm_.push_back(along_mm_.back() + norm(path_mm_[n] - path_mm_[n - 1]));
  if (!(round_mm() > 1))
    throw Error(ExitCode::usage, "", "--target-radius-mm", "the target's path is shorter than a millimetre");
}

double MovingTarget::way_mm(double time_s) const {
  return std::fmod(std::max(0.0, time_s - begins_s_) * speed_mm_per_s_, round_mm());
}

Vec3 MovingTarget::place_mm(double way) const {
  const auto behind = std::upper_bound(along_mm_.begin() + 1, along_mm_.end() - 1, way);
  const std::size_t n = std::size_t(behind - along_mm_.begin());
  const double length = along_mm_[n] - along_mm_[n - 1];
  return path_mm_[n - 1] + (path_mm_[n] - path_mm_[n - 1]) * (length > 0 ? (way - along_mm_[n - 1]) / length : 0);
}

double MovingTarget::behind_mm(double time_s, Vec3 tip) const {
  double nearest = 1e300, way = 0;
  for (std::size_t n = 1; n < path_mm_.size(); ++n) {
    const Vec3 piece = path_mm_[n] - path_mm_[n - 1];
    const double length2 = dot(piece, piece);
    const double share = length2 > 0 ? std::clamp(dot(tip - path_mm_[n - 1], piece) / length2, 0.0, 1.0) : 0;
    const double off = norm(path_mm_[n - 1] + piece * share - tip);
    if (off < nearest) {
      nearest = off;
      way = along_mm_[n - 1] + share * std::sqrt(length2);
    }
  }
  return std::remainder(way_mm(time_s) - way, round_mm());
}

std::shared_ptr<const MovingTarget> target_of(const haptics::RecordingHeader& header, const Patient& patient) {
  if (!header.target.target) return nullptr;
  return std::make_shared<const MovingTarget>(header.target, patient.contact,
                                              haptics::touchable_of(patient.felt.feels));
}

void TargetWatch::look(const haptics::ServoFrame& frame) {
  if (!target_->runs(frame.time_s)) return;
  seconds_ += frame.dt_s;
  if (frame.touched != 0) touching_s_ += frame.dt_s;
  const Vec3 tip{frame.proxy_mm[0], frame.proxy_mm[1], frame.proxy_mm[2]};
  if (frame.time_s < next_s_ || !is_finite(tip)) return;
  next_s_ = frame.time_s + 1 / looks_per_s - 1e-9;
  off_mm_.push_back(norm(target_->at_mm(frame.time_s) - tip));
  behind_mm_.push_back(target_->behind_mm(frame.time_s, tip));
}

TargetFigures TargetWatch::figures() const {
  TargetFigures f;
  if (off_mm_.empty() || !(seconds_ > 0)) return f;
  f.seconds = seconds_;
  for (std::size_t n = 0; n < off_mm_.size(); ++n) {
    f.mean_off_mm += off_mm_[n] / double(off_mm_.size());
    f.mean_behind_mm += behind_mm_[n] / double(off_mm_.size());
    f.most_off_mm = std::max(f.most_off_mm, off_mm_[n]);
  }
  f.p95_off_mm = at_share(off_mm_, 0.95);
  f.p95_behind_mm = at_share(behind_mm_, 0.95);
  f.mean_behind_s = f.mean_behind_mm / target_->speed_mm_per_s();
  f.touching_ratio = touching_s_ / seconds_;
  return f;
}

std::string target_text(const TargetFigures& f) {
  if (!(f.seconds > 0)) return "";
  return fmt::format(
      "followed for {:.1f} s, {:.1f} % of them touching: {:.2f} mm off in the mean, 95 % within {:.2f}, at most "
      "{:.2f}; "
      "behind by {:.2f} mm ({:.3f} s) in the mean, 95 % by less than {:.2f}",
      f.seconds, 100 * f.touching_ratio, f.mean_off_mm, f.p95_off_mm, f.most_off_mm, f.mean_behind_mm, f.mean_behind_s,
      f.p95_behind_mm);
}

}  // namespace trephine::session
