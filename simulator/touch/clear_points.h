// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <vector>

#include "touch/felt_space.h"

namespace trephine::touch {

/// Which points of a rigid tool, on their straight ways from one pose to another, surely meet and pass nothing: each
/// was once so far from everything that it cannot have come there since. Whoever walks the ways of the others alone
/// finds what he would find by walking all, to the bit.
///
/// Poses are the tip and the frame. Only the constructor allocates.
class ClearPoints {
 public:
  /// `space` must outlive it. The shapes are those of the points, in which they are.
  ClearPoints(const FeltSpace& space, std::vector<Vec3> points_mm, const std::vector<std::uint8_t>& shapes);
  /// Must be called once in each frame: what was found is forgotten where the volume may have been cut since.
  void begin_frame();
  void forget() { known_ = false; }
  /// The point is in another shape than before.
  void changed(std::size_t point);

  /// How far points have moved at most from where they were looked at: the tip, and a place at a distance of 1 from it.
  struct Moved {
    double tip_mm = 0, turn = 0;
  };
  struct Way {
    Moved begin, end;
    Moved until(double share) const {
      const auto most = [share](double a, double b) { return a > b ? a : a + (b - a) * share; };
      return {most(begin.tip_mm, end.tip_mm), most(begin.turn, end.turn)};
    }
  };
  /// The way from a pose, which is the one that the tool has; looks anew where it has moved too far.
  Way way(Vec3 from_mm, const Mat3& from, Vec3 to_mm, const Mat3& to);
  bool all_are(const Moved& moved) const { return moved.tip_mm + moved.turn * length_mm_ < least_mm_; }
  bool is(std::size_t point, const Moved& moved) const {
    return moved.tip_mm + moved.turn * far_mm_[point] < clear_mm_[point];
  }
  /// The same of one way, with a closer look.
  bool is(std::size_t point, Vec3 from_mm, Vec3 to_mm);

 private:
  Moved moved_to(Vec3 tip_mm, const Mat3& frame) const;
  void look(Vec3 tip_mm, const Mat3& frame);
  const FeltSpace& space_;
  const std::vector<Vec3> points_mm_;
  const std::vector<std::uint8_t>& shapes_;
  std::vector<double> far_mm_;  // of the points, from the tip
  double length_mm_ = 0;        // of these the largest
  // Of each point, a distance from where it was at that pose within which all is of the shape that it is in.
  std::vector<double> clear_mm_;
  std::vector<char> looked_close_;
  double least_mm_ = 0;
  Vec3 tip_mm_;
  Mat3 frame_;
  std::uint32_t seen_ = 0;
  bool known_ = false;
  double stale_mm_ = 0;  // a tool that has moved so far is looked at again
};

/// How far a place at a distance of 1 from the tip moves at most.
double turn_between(const Mat3& from, const Mat3& to);

/// The longest of the ways of a rigid tool's points. Only the constructor allocates.
class LongestWay {
 public:
  explicit LongestWay(const std::vector<Vec3>& points_mm);
  double of(Vec3 from_mm, const Mat3& from, Vec3 to_mm, const Mat3& to);

 private:
  struct Places {
    std::vector<double> x, y, z;
    void add(Vec3 p);
  };
  Places all_, outer_;  // the points; and those that are not between two others on a line along the axis
  std::vector<double> squared_;
};

}  // namespace trephine::touch
