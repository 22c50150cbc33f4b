// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <vector>

#include "base/vec3.h"
#include "touch/clear_points.h"
#include "touch/felt_space.h"

namespace trephine::haptics {

/// A rigid set of points in a haptic volume, each of which knows the shape in which it is. It moves only along ways
/// that were walked point by point, so no point crosses a face that was touchable, whatever the rounding. The space
/// between two points is not felt: the edge of a wall thinner than their distance may stand between them.
///
/// Only the constructor allocates.
class ToolBody {
 public:
  /// `points_mm`: at least one, from the tip to the tail.
  ToolBody(const touch::FeltSpace& contact, std::vector<Vec3> points_mm);

  int count() const { return int(points_mm_.size()); }
  Vec3 tip_mm() const { return tip_mm_; }
  const Mat3& frame() const { return frame_; }
  Vec3 at_mm(int point) const { return tip_mm_ + frame_ * points_mm_[std::size_t(point)]; }
  int shape(int point) const { return shape_[std::size_t(point)]; }

  /// Puts the body there, each point in whatever shape is there. Returns false where a point lies in a shape whose bit
  /// is set in `avoid`; the body is then placed in part or not at all.
  bool place(Vec3 tip_mm, const Mat3& frame, std::uint64_t avoid = 0);

  /// How many points place() has examined so far, as a measure of its cost.
  std::uint64_t looked_at() const { return looked_at_; }

  /// Must be called once in each frame: it forgets what was learnt of the volume where it may have been cut since.
  void begin_frame();

  /// What a sweep meets: the point that collides first, and of those that collide with it (within a tenth of the
  /// smallest voxel side along their ways, or one voxel where boxes are felt) the first from the tip and the first from
  /// the tail.
  struct Meeting {
    bool hit = false;
    double along = 1;
    int nearest = 0, from_tip = 0, from_tail = 0;
  };
  /// Walks every point's straight way to that pose, without moving the body.
  Meeting sweep(Vec3 tip_mm, const Mat3& frame, const contact::TouchableFaces& faces);
  const contact::Contact& met(int point) const { return met_[std::size_t(point)]; }  ///< without a normal
  Vec3 way(int point) const { return to_mm_ + arm(point) - at_mm(point); }
  /// From the tip to the point, at the pose that was swept to.
  Vec3 arm(int point) const { return to_frame_ * points_mm_[std::size_t(point)]; }

  /// Moves to the end of the last sweep, which met nothing.
  void arrive();
  /// Moves along that share of the last sweep's way, which met nothing so far. A turn leaves the straight ways, so its
  /// result is walked again and shortened where it meets something. Returns false where the body did not move.
  bool advance(double share, const contact::TouchableFaces& faces);

 private:
  contact::Contact walk(std::size_t point, Vec3 from_mm, Vec3 end_mm, const contact::TouchableFaces& faces) {
    walks_ = true;
    return contact_.cross(from_mm, end_mm, shape_[point], faces, &known_[point]);
  }
  void enter(std::size_t point, int shape);
  bool try_pose(Vec3 tip_mm, const Mat3& frame, const contact::TouchableFaces& faces, bool all);
  const touch::FeltSpace& contact_;
  std::vector<Vec3> points_mm_;
  double length_mm_ = 0;  // from the tip to the point that is farthest
  Vec3 tip_mm_, to_mm_;
  Mat3 frame_, to_frame_;
  std::vector<std::uint8_t> shape_;
  touch::ClearPoints clear_;
  touch::LongestWay longest_;
  std::vector<contact::Contact> met_;
  std::vector<contact::ContactBox> known_;
  bool walks_ = false;  // something may be known
  // Points that the last sweep walked; all others were known to meet and to pass nothing.
  std::vector<int> walked_;
  int walked_count_ = 0;
  struct Change {
    std::size_t point;
    int into;
  };
  std::vector<Change> changed_;  // by the pose that is tried
  double together_mm_;
  std::size_t barred_ = 0;  // the point that place() found last
  std::uint64_t looked_at_ = 0;
  int first_ = 0;  // the point that collided last: it is walked first, and other points only as far as its contact
};

}  // namespace trephine::haptics
