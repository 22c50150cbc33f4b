// SPDX-License-Identifier: GPL-3.0-or-later
#include "haptics/tool_body.h"

#include <algorithm>

#include "haptics/tool.h"

namespace trephine::haptics {
namespace {

constexpr double rounding_mm = 1e-6;  // far beyond what rounding moves a point

}  // namespace

ToolBody::ToolBody(const touch::FeltSpace& contact, std::vector<Vec3> points_mm)
    : contact_(contact),
      points_mm_(std::move(points_mm)),
      shape_(points_mm_.size()),
      clear_(contact, points_mm_, shape_),
      longest_(points_mm_) {
  const std::size_t n = points_mm_.size();
  met_.resize(n);
  known_.resize(n);
  walked_.resize(n);
  changed_.resize(n);
  for (const Vec3 p : points_mm_) length_mm_ = std::max(length_mm_, norm(p));
  const bool boxes = contact.params().surface == contact::ContactParams::Surface::nearest;
  together_mm_ = (boxes ? 1 : 0.1) * contact.smallest_side_mm();
}

void ToolBody::begin_frame() {
  if (walks_) std::fill(known_.begin(), known_.end(), contact::ContactBox{});
  walks_ = false;
  clear_.begin_frame();
}

bool ToolBody::place(Vec3 tip_mm, const Mat3& frame, std::uint64_t avoid) {
  const auto barred = [&](Vec3 at, int* shape) {
    ++looked_at_;
    *shape = contact_.shape_at(at);
    return *shape != 0 && (avoid >> *shape & 1);
  };
  // A search that tries one pose after another mostly finds the same point barred, so that point is looked at first.
  int shape = 0;
  if (barred(tip_mm + frame * points_mm_[barred_], &shape)) return false;
  tip_mm_ = tip_mm;
  frame_ = frame;
  begin_frame();
  clear_.forget();
  for (std::size_t i = 0; i < points_mm_.size(); ++i) {
    const bool bar = barred(at_mm(int(i)), &shape);
    shape_[i] = std::uint8_t(shape);
    if (bar) {
      barred_ = i;
      return false;
    }
  }
  return true;
}

ToolBody::Meeting ToolBody::sweep(Vec3 tip_mm, const Mat3& frame, const contact::TouchableFaces& faces) {
  to_mm_ = tip_mm;
  to_frame_ = frame;
  walked_count_ = 0;
  Meeting m;
  const touch::ClearPoints::Way way = clear_.way(tip_mm_, frame_, tip_mm, frame);
  touch::ClearPoints::Moved moved = way.until(1);
  if (clear_.all_are(moved)) return m;
  double until = 1, together = 1;  // contacts beyond this share of the way do not matter
  const auto walk_point = [&](std::size_t i) {
    const Vec3 from = at_mm(int(i)), whole = tip_mm + frame * points_mm_[i];
    const Vec3 to = until < 1 ? from + (whole - from) * until : whole;
    if (clear_.is(i, from, to)) return;
    walked_[std::size_t(walked_count_++)] = int(i);
    contact::Contact& c = met_[i];
    c = walk(i, from, to, faces);
    if (!c.hit) return;
    c.along *= until;
    if (m.hit && c.along >= m.along) return;
    if (!m.hit) {
      const double most_mm = norm(tip_mm - tip_mm_) + touch::turn_between(frame_, frame) * length_mm_;
      const double longest = most_mm + rounding_mm > together_mm_ ? longest_.of(tip_mm_, frame_, tip_mm, frame) : 0;
      together = longest > together_mm_ ? together_mm_ / longest : 1;
    }
    m.hit = true;
    m.along = c.along;
    m.nearest = int(i);
    until = std::min(1.0, m.along + together);
    moved = way.until(until);
  };
  walk_point(std::size_t(first_));
  for (std::size_t i = 0; i < points_mm_.size(); ++i)
    if (i != std::size_t(first_) && !clear_.is(i, moved)) walk_point(i);
  if (!m.hit) return m;
  m.from_tip = m.from_tail = first_ = m.nearest;
  for (int n = 0; n < walked_count_; ++n) {
    const int i = walked_[std::size_t(n)];
    if (!met(i).hit || met(i).along > until) continue;
    m.from_tip = std::min(m.from_tip, i);
    m.from_tail = std::max(m.from_tail, i);
  }
  return m;
}

void ToolBody::arrive() {
  tip_mm_ = to_mm_;
  frame_ = to_frame_;
  for (int n = 0; n < walked_count_; ++n) {
    const auto i = std::size_t(walked_[std::size_t(n)]);
    enter(i, met_[i].into);
  }
}

void ToolBody::enter(std::size_t point, int shape) {
  if (shape_[point] == shape) return;
  shape_[point] = std::uint8_t(shape);
  known_[point] = {};
  clear_.changed(point);
}

// Moves to the pose if no point meets anything. Without `all`, only points that met or passed a face are looked at.
bool ToolBody::try_pose(Vec3 tip_mm, const Mat3& frame, const contact::TouchableFaces& faces, bool all) {
  int changes = 0;
  const auto meets = [&](std::size_t i) {
    const Vec3 from = at_mm(int(i)), to = tip_mm + frame * points_mm_[i];
    if (clear_.is(i, from, to)) return false;
    const contact::Contact c = walk(i, from, to, faces);
    if (!c.hit && c.into != shape_[i]) changed_[std::size_t(changes++)] = {i, c.into};
    return c.hit;
  };
  if (all) {
    const touch::ClearPoints::Moved moved = clear_.way(tip_mm_, frame_, tip_mm, frame).until(1);
    for (std::size_t i = 0; i < points_mm_.size(); ++i)
      if (!clear_.is(i, moved) && meets(i)) return false;
  } else {
    for (int n = 0; n < walked_count_; ++n) {
      const auto i = std::size_t(walked_[std::size_t(n)]);
      if ((met_[i].hit || met_[i].passed) && meets(i)) return false;
    }
  }
  tip_mm_ = tip_mm;
  frame_ = frame;
  for (int n = 0; n < changes; ++n) enter(changed_[std::size_t(n)].point, changed_[std::size_t(n)].into);
  return true;
}

bool ToolBody::advance(double share, const contact::TouchableFaces& faces) {
  const bool turning = !(to_frame_ == frame_);
  if (!(share > 0)) return false;
  for (int n = 0; n < (turning ? 3 : 1); ++n, share *= 0.5) {
    Mat3 frame = frame_;
    if (turning) {
      const Vec3 w = frame_.column[2];
      frame = turned(frame_, w + (to_frame_.column[2] - w) * share);
    }
    if (try_pose(tip_mm_ + (to_mm_ - tip_mm_) * share, frame, faces, turning)) return true;
  }
  return false;
}

}  // namespace trephine::haptics
