// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <vector>

#include "drill/cutter.h"
#include "grid/grid.h"

namespace trephine::drill {

/// A straight piece of a tool's way, which is cut in so many passes.
struct ToolWay {
  ToolPose from;
  Vec3 to_tip_mm;
  Wider wider;
  double time_s = 0, energy_j = 0;
  int passes = 1, pass = 0;
  int cutter = 0;       ///< number in ToolWays
  bool breaks = false;  ///< what lies there breaks away, and its energy is no power's
};

/// The ways that cutters went and that are still to be cut, oldest first, and the cutters. Only add_cutter allocates.
class ToolWays {
 public:
  static constexpr int pass_voxels = 8000;  ///< that a pass looks at
  explicit ToolWays(const grid::Lattice& lattice) : lattice_(lattice) {}
  void add_cutter(const Cutter& cutter) { cutters_.push_back(cutter); }
  const Cutter& cutter(int number) const { return cutters_[std::size_t(number)]; }

  bool empty() const { return count_ == 0; }
  bool full() const { return count_ == max_ways; }
  ToolWay& oldest() { return at(0); }
  void drop_oldest();
  void clear() { count_ = 0; }
  /// Makes it part of the newest way, where that has not begun and goes on straight to a quarter of a voxel, or where
  /// there is no room for one more.
  bool join(const ToolWay& way);
  /// There must be room.
  void add(const ToolWay& way) { at(count_++) = way; }
  /// Makes one of the last two neighbours that one cutter went and that have not begun; none where there are none.
  void join_any();
  /// How many voxels have to be looked at for a way, those of the box around it, and in how many passes.
  double voxels_of(const ToolWay& way) const;
  int passes_of(const ToolWay& way) const;

 private:
  static constexpr int max_ways = 32;
  ToolWay& at(int n) { return ways_[std::size_t((first_ + n) % max_ways)]; }
  bool join(ToolWay& last, const ToolWay& way, bool always) const;
  const grid::Lattice& lattice_;
  std::vector<Cutter> cutters_;
  std::array<ToolWay, max_ways> ways_{};  // a ring
  int first_ = 0, count_ = 0;
};

/// The same place of the cutter with another frame: of a ball the centre stays, of others the tip.
Vec3 tip_in(const Cutter& cutter, const Mat3& frame, const ToolPose& pose);

}  // namespace trephine::drill
