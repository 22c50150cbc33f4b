// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/pivot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/pi.h"
#include "base/rank.h"
#include "base/refusal.h"
#include "base/symmetric_eigen.h"
#include "track/inliers.h"

namespace trephine::track {
namespace {

constexpr std::size_t parts = 8;
constexpr int rounds = 12;
constexpr double least_scale_mm = 0.05;  // of what is taken for a slip
constexpr double most_outliers = 0.3;
constexpr double least_spin_deg = 20, most_wobble_ratio = 0.35;

// Of the rotations about their mean: what of a place in the body moves, squared and summed.
struct Turning {
  Mat3 mean;
  Vec3 mean_mm;
  SquareMatrix<3> moves{};
  Vec3 against;  // of the normal equations
};

Turning turning_of(const std::vector<RigidMap>& poses) {
  Turning t;
  for (Vec3& c : t.mean.column) c = {};
  const double n = double(poses.size());
  for (const RigidMap& p : poses) {
    for (std::size_t k = 0; k < 3; ++k) t.mean.column[k] += p.turn.column[k] / n;
    t.mean_mm += p.offset_mm / n;
  }
  for (const RigidMap& p : poses) {
    std::array<Vec3, 3> off;
    for (std::size_t k = 0; k < 3; ++k) off[k] = p.turn.column[k] - t.mean.column[k];
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t k = 0; k < 3; ++k) t.moves[i][k] += dot(off[i], off[k]);
      t.against[int(i)] -= dot(off[i], p.offset_mm - t.mean_mm);
    }
  }
  return t;
}

double degrees(double mean_square) {
  return std::asin(std::min(1.0, std::sqrt(std::max(0.0, mean_square)))) * 180 / pi;
}

struct Solved {
  Vec3 tip_mm, rest_mm;
  double spread_deg = 0;
};
Solved solve(const std::vector<RigidMap>& poses) {
  const Turning t = turning_of(poses);
  const auto axes = symmetric_eigen<3>(t.moves);
  Solved s;
  for (const EigenPair<3>& a : axes) {
    const Vec3 v{a.vector[0], a.vector[1], a.vector[2]};
    if (a.value > 1e-12) s.tip_mm += v * (dot(v, t.against) / a.value);
  }
  s.rest_mm = t.mean * s.tip_mm + t.mean_mm;
  s.spread_deg = degrees(axes[0].value / double(poses.size()));
  return s;
}

std::vector<double> off_of(const std::vector<RigidMap>& poses, const Solved& s) {
  std::vector<double> off;
  off.reserve(poses.size());
  for (const RigidMap& p : poses) off.push_back(norm(p(s.tip_mm) - s.rest_mm));
  return off;
}

std::vector<RigidMap> without_part(const std::vector<RigidMap>& poses, std::size_t part) {
  std::vector<RigidMap> others;
  for (std::size_t n = 0; n < poses.size(); ++n)
    if (n * parts / poses.size() != part) others.push_back(poses[n]);
  return others;
}

// Of all poses, or of all without one part of the time, what most of them agree with: a part may be gross.
Solved begin_of(const std::vector<RigidMap>& poses) {
  Solved best;
  double least = 1e300;
  for (std::size_t part = 0; part <= parts; ++part) {
    const Solved s = solve(without_part(poses, part));
    const double middle = median_of(off_of(poses, s));
    if (middle < least) least = middle, best = s;
  }
  return best;
}

}  // namespace

PivotTip pivot_tip(const std::vector<RigidMap>& poses, const PivotParams& params) {
  const Remedy again{
      "rest the tip in a small hollow that does not move, and tilt the tool slowly to all sides, for more "
      "`pivot_poses`"};
  if (poses.size() < least_poses)
    throw refusal("tip", fmt::format("{} poses were given, at least {} are needed", poses.size(), least_poses), again);
  std::vector<RigidMap> used = poses;
  Solved s = begin_of(poses);
  for (int round = 0; round < rounds; ++round) {
    const std::vector<RigidMap> kept = inliers(poses, off_of(poses, s), least_scale_mm);
    const bool same = kept.size() == used.size() && round > 0;
    used = kept;
    s = solve(used);
    if (same) break;
  }
  PivotTip tip;
  tip.tip_mm = s.tip_mm;
  tip.rest_mm = s.rest_mm;
  tip.spread_deg = s.spread_deg;
  tip.used = used.size();
  tip.outliers = poses.size() - used.size();
  double squares = 0;
  for (const double off : off_of(used, s)) squares += off * off / double(used.size());
  tip.residual_mm = std::sqrt(squares);
  if (!(tip.spread_deg >= params.least_spread_deg))
    throw refusal("tip",
                  fmt::format("the tool was turned by {:.1f} degrees about its tip, at least {:g} (least_spread_deg) "
                              "are needed",
                              tip.spread_deg, params.least_spread_deg),
                  {"tilt it farther, by 30 degrees to all sides, with the tip in its hollow, for all `pivot_poses`"});
  if (double(tip.outliers) > most_outliers * double(poses.size()) || !(tip.residual_mm <= params.largest_pivot_mm))
    throw refusal("tip",
                  fmt::format("the tip was off its place by {:.2f} mm, at most {:g} (largest_pivot_mm) are allowed; {} "
                              "of {} poses were left out",
                              tip.residual_mm, params.largest_pivot_mm, tip.outliers, poses.size()),
                  again);
  // Parts of the time, for neighbours err alike.
  double around = 0;
  for (std::size_t part = 0; part < parts; ++part) {
    const Vec3 off = solve(without_part(used, part)).tip_mm - tip.tip_mm;
    around += dot(off, off);
  }
  tip.tip_error_mm = std::sqrt(around * double(parts - 1) / double(parts));
  if (!(tip.tip_error_mm <= params.largest_tip_error_mm))
    throw refusal("tip",
                  fmt::format("its place is known to {:.2f} mm, at most {:g} (largest_tip_error_mm) are allowed",
                              tip.tip_error_mm, params.largest_tip_error_mm),
                  again);
  return tip;
}

Vec3 spin_axis(const std::vector<RigidMap>& poses, Vec3 tip_mm) {
  const Remedy again{
      "leave the tip in its hollow and turn the tool about its own axis, by half a turn or more, for all `spin_poses`"};
  if (poses.size() < least_poses)
    throw refusal("axis", fmt::format("{} poses were given, at least {} are needed", poses.size(), least_poses), again);
  const auto axes = symmetric_eigen<3>(turning_of(poses).moves);
  const double turned = degrees(axes[1].value / double(poses.size()));
  if (!(turned >= least_spin_deg) || !(axes[0].value <= most_wobble_ratio * axes[1].value))
    throw refusal("axis", fmt::format("the tool was not turned about one axis, or by {:.0f} degrees alone", turned),
                  again);
  const Vec3 axis = normalized({axes[0].vector[0], axes[0].vector[1], axes[0].vector[2]});
  return dot(axis, tip_mm) > 0 ? -axis : axis;
}

}  // namespace trephine::track
