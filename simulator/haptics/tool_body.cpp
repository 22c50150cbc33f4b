// SPDX-License-Identifier: GPL-3.0-or-later
#include "haptics/tool_body.h"

#include <algorithm>

#include "haptics/tool.h"

namespace trephine::haptics {

ToolBody::ToolBody(const touch::FeltSpace& contact, std::vector<Vec3> points_mm)
    : contact_(contact), points_mm_(std::move(points_mm)) {
  const std::size_t n = points_mm_.size();
  at_.resize(n);
  end_.resize(n);
  arm_.resize(n);
  tried_.resize(n);
  shape_.resize(n);
  tried_shape_.resize(n);
  met_.resize(n);
  known_.resize(n);
  const bool boxes = contact.params().surface == contact::ContactParams::Surface::nearest;
  together_mm_ = (boxes ? 1 : 0.1) * contact.smallest_side_mm();
}

void ToolBody::begin_frame() { std::fill(known_.begin(), known_.end(), contact::ContactBox{}); }

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
  for (std::size_t i = 0; i < points_mm_.size(); ++i) {
    at_[i] = tip_mm + frame * points_mm_[i];
    const bool bar = barred(at_[i], &shape);
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
  double longest = 0;
  for (std::size_t i = 0; i < points_mm_.size(); ++i) {
    arm_[i] = frame * points_mm_[i];
    end_[i] = tip_mm + arm_[i];
    const Vec3 d = end_[i] - at_[i];
    longest = std::max(longest, dot(d, d));
  }
  longest = std::sqrt(longest);
  const double together = longest > together_mm_ ? together_mm_ / longest : 1;
  Meeting m;
  double until = 1;  // contacts beyond this share of the way do not matter
  const auto walk_point = [&](std::size_t i) {
    contact::Contact& c = met_[i];
    c = walk(i, until < 1 ? at_[i] + (end_[i] - at_[i]) * until : end_[i], faces);
    if (!c.hit) return;
    c.along *= until;
    if (m.hit && c.along >= m.along) return;
    m.hit = true;
    m.along = c.along;
    m.nearest = int(i);
    until = std::min(1.0, m.along + together);
  };
  walk_point(std::size_t(first_));
  for (std::size_t i = 0; i < points_mm_.size(); ++i)
    if (i != std::size_t(first_)) walk_point(i);
  if (!m.hit) return m;
  m.from_tip = m.from_tail = first_ = m.nearest;
  for (int i = 0; i < count(); ++i)
    if (met(i).hit && met(i).along <= until) {
      m.from_tip = std::min(m.from_tip, i);
      m.from_tail = std::max(m.from_tail, i);
    }
  return m;
}

void ToolBody::arrive() {
  tip_mm_ = to_mm_;
  frame_ = to_frame_;
  std::swap(at_, end_);
  for (std::size_t i = 0; i < at_.size(); ++i) enter(i, met_[i].into);
}

void ToolBody::enter(std::size_t point, int shape) {
  if (shape_[point] == shape) return;
  shape_[point] = std::uint8_t(shape);
  known_[point] = {};
}

// Moves to the pose if no point meets anything. Without `all`, only points that met or passed a face are looked at.
bool ToolBody::try_pose(Vec3 tip_mm, const Mat3& frame, const contact::TouchableFaces& faces, bool all) {
  for (std::size_t i = 0; i < at_.size(); ++i) {
    tried_[i] = tip_mm + frame * points_mm_[i];
    tried_shape_[i] = shape_[i];
    if (!all && !met_[i].hit && !met_[i].passed) continue;
    const contact::Contact c = walk(i, tried_[i], faces);
    if (c.hit) return false;
    tried_shape_[i] = std::uint8_t(c.into);
  }
  tip_mm_ = tip_mm;
  frame_ = frame;
  std::swap(at_, tried_);
  for (std::size_t i = 0; i < at_.size(); ++i) enter(i, tried_shape_[i]);
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
