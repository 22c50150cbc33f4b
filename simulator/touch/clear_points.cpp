// SPDX-License-Identifier: GPL-3.0-or-later
#include "touch/clear_points.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace trephine::touch {
namespace {

constexpr double rounding_mm = 1e-6;  // far beyond what rounding moves a point
// How far a tool moves until it is looked at again: at the begin of a frame, and within one.
constexpr double stale_voxels = 0.1, stale_within_voxels = 0.6;
constexpr double least_inner_mm = 0.1, clear_turn = 1e-4;

}  // namespace

double turn_between(const Mat3& from, const Mat3& to) {
  double squared = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const Vec3 d = to.column[a] - from.column[a];
    squared += dot(d, d);
  }
  return std::sqrt(squared);
}

ClearPoints::ClearPoints(const FeltSpace& space, std::vector<Vec3> points_mm, const std::vector<std::uint8_t>& shapes)
    : space_(space), points_mm_(std::move(points_mm)), shapes_(shapes) {
  clear_mm_.resize(points_mm_.size());
  looked_close_.resize(points_mm_.size());
  for (const Vec3 p : points_mm_) {
    far_mm_.push_back(norm(p));
    length_mm_ = std::max(length_mm_, far_mm_.back());
  }
}

void ClearPoints::begin_frame() {
  const std::uint32_t seen = space_.contact().loosened();
  if (seen != seen_) known_ = false;
  seen_ = seen;
  stale_mm_ = stale_voxels * space_.smallest_side_mm();
}

void ClearPoints::changed(std::size_t point) {
  clear_mm_[point] = least_mm_ = 0;
  looked_close_[point] = 1;
}

ClearPoints::Moved ClearPoints::moved_to(Vec3 tip_mm, const Mat3& frame) const {
  return {norm(tip_mm - tip_mm_), turn_between(frame_, frame)};
}

ClearPoints::Way ClearPoints::way(Vec3 from_mm, const Mat3& from, Vec3 to_mm, const Mat3& to) {
  Way way{moved_to(from_mm, from), moved_to(to_mm, to)};
  if (known_ && (all_are(way.until(1)) || way.begin.tip_mm + way.begin.turn * length_mm_ <= stale_mm_)) return way;
  look(from_mm, from);
  stale_mm_ = stale_within_voxels * space_.smallest_side_mm();
  return {moved_to(from_mm, from), moved_to(to_mm, to)};
}

void ClearPoints::look(Vec3 tip_mm, const Mat3& frame) {
  tip_mm_ = tip_mm;
  frame_ = frame;
  known_ = true;
  space_.clear_mm(tip_mm, frame, points_mm_, shapes_, clear_mm_);
  least_mm_ = 1e9;
  for (double& clear : clear_mm_) least_mm_ = std::min(least_mm_, clear -= rounding_mm);
  std::fill(looked_close_.begin(), looked_close_.end(), char(0));
}

// A straight way stays in the ball around where the point was if both of its ends lie in it.
bool ClearPoints::is(std::size_t point, Vec3 from_mm, Vec3 to_mm) {
  const Vec3 was = tip_mm_ + frame_ * points_mm_[point], a = from_mm - was, b = to_mm - was;
  const double squared = std::max(dot(a, a), dot(b, b));
  double& clear = clear_mm_[point];
  if (clear > 0 && squared < clear * clear) return true;
  if (looked_close_[point]) return false;
  looked_close_[point] = 1;
  clear = std::max(clear, space_.clear_beside_mm(was, shapes_[point]) - rounding_mm);
  return clear > 0 && squared < clear * clear;
}

void LongestWay::Places::add(Vec3 p) {
  x.push_back(p.x);
  y.push_back(p.y);
  z.push_back(p.z);
}

LongestWay::LongestWay(const std::vector<Vec3>& points_mm) : squared_(points_mm.size()) {
  std::map<std::pair<double, double>, std::pair<double, double>> lines;  // from where to where along the axis
  for (const Vec3 p : points_mm) {
    std::pair<double, double>& ends = lines.try_emplace({p.x, p.y}, p.z, p.z).first->second;
    ends = {std::min(ends.first, p.z), std::max(ends.second, p.z)};
  }
  for (const Vec3 p : points_mm) {
    const auto [first, last] = lines[{p.x, p.y}];
    all_.add(p);
    if (p.z < first + least_inner_mm || p.z > last - least_inner_mm) outer_.add(p);
  }
}

// The square of a way is convex along a line of points: a turn that is more than rounding makes an outer one the
// longest.
double LongestWay::of(Vec3 from_mm, const Mat3& from, Vec3 to_mm, const Mat3& to) {
  const Places& p = norm(to.column[2] - from.column[2]) > clear_turn ? outer_ : all_;
  double* const out = squared_.data();
  const std::size_t size = p.x.size();
  const bool same = to == from;
  for (std::size_t n = 0; n < size && same; ++n) {
    const Vec3 arm = from * Vec3{p.x[n], p.y[n], p.z[n]}, d = (to_mm + arm) - (from_mm + arm);
    out[n] = dot(d, d);
  }
  for (std::size_t n = 0; n < size && !same; ++n) {
    const Vec3 at{p.x[n], p.y[n], p.z[n]}, d = (to_mm + to * at) - (from_mm + from * at);
    out[n] = dot(d, d);
  }
  double longest = 0;
  for (std::size_t n = 0; n < size; ++n) longest = std::max(longest, out[n]);
  return std::sqrt(longest);
}

}  // namespace trephine::touch
