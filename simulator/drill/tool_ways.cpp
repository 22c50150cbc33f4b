// SPDX-License-Identifier: GPL-3.0-or-later
#include "drill/tool_ways.h"

#include <algorithm>
#include <cmath>

namespace trephine::drill {
namespace {

constexpr int max_passes = 4096;
constexpr double straight_voxels = 0.25;  // how far a way may leave its chord
constexpr double max_turn = 0.02;         // of a cylinder on one way, rad
constexpr double longest_mm = 40;         // of ways that are made one

double length_of(const Cutter& c) { return c.kind == Cutter::Kind::ball ? 0 : c.height_mm; }
double width_of(const Cutter& c) {
  return 2 * (c.kind == Cutter::Kind::ball ? c.radius_mm : std::max(c.semi_a_mm, c.semi_b_mm));
}

// How far the frame of a way turns until another one, where that matters for what the cutter fills.
double turn_between(const Cutter& c, const Mat3& a, const Mat3& b) {
  if (c.kind == Cutter::Kind::ball) return 0;
  return norm(a.column[2] - b.column[2]) + (c.semi_a_mm == c.semi_b_mm ? 0 : norm(a.column[0] - b.column[0]));
}

}  // namespace

Vec3 tip_in(const Cutter& c, const Mat3& frame, const ToolPose& pose) {
  if (c.kind != Cutter::Kind::ball) return pose.tip_mm;
  return pose.tip_mm + (pose.frame.column[2] - frame.column[2]) * c.radius_mm;
}

// How many voxels have to be looked at for a way: those of the box around it.
double ToolWays::voxels_of(const ToolWay& way) const {
  const Vec3 s = lattice_.spacing_mm;
  const Cutter& cutter = this->cutter(way.cutter);
  const double ramp = std::max({s.x, s.y, s.z}), radius = 0.5 * width_of(cutter) + way.wider.most_mm() + ramp;
  const double length = norm(way.to_tip_mm - way.from.tip_mm) + length_of(cutter);
  return (M_PI * radius * radius * length + 4.0 / 3 * M_PI * radius * radius * radius) / lattice_.voxel_volume_mm3();
}

// A pass looks at no more than some thousand voxels.
int ToolWays::passes_of(const ToolWay& way) const {
  return std::clamp(int(std::ceil(voxels_of(way) / pass_voxels)), 1, max_passes);
}

// Makes the way part of the last one, where that has not begun and goes on straight, or `always`. Both are of one
// cutter.
bool ToolWays::join(ToolWay& last, const ToolWay& way, bool always) const {
  const Cutter& cutter = this->cutter(last.cutter);
  const Vec3 chord = way.to_tip_mm - last.from.tip_mm, middle = last.to_tip_mm - last.from.tip_mm;
  const double squared = dot(chord, chord);
  const double off =
      squared > 0 ? norm(middle - chord * std::clamp(dot(middle, chord) / squared, 0.0, 1.0)) : norm(middle);
  const Vec3 s = lattice_.spacing_mm;
  const bool joins = off <= straight_voxels * std::min({s.x, s.y, s.z}) && squared <= longest_mm * longest_mm &&
                     turn_between(cutter, last.from.frame, way.from.frame) <= max_turn;
  if (last.pass != 0 || !(joins || always)) return false;
  last.from.tip_mm = tip_in(cutter, way.from.frame, last.from);
  last.from.frame = way.from.frame;
  last.to_tip_mm = way.to_tip_mm;
  const drill::Wider was = last.wider;
  last.wider = way.wider;
  last.wider.mm = std::max(was.mm, way.wider.mm);
  last.wider.held_mm = std::max(was.held_mm, way.wider.held_mm);
  last.time_s += way.time_s;
  last.energy_j += way.energy_j;
  return true;
}

// Makes one of the last two neighbours that one cutter went and that have not begun; none where there are none.
void ToolWays::join_any() {
  int n = count_ - 1;
  while (n > 0 && !(at(n - 1).cutter == at(n).cutter && join(at(n - 1), at(n), true))) --n;
  if (n <= 0) return;
  for (; n + 1 < count_; ++n) at(n) = at(n + 1);
  --count_;
}

bool ToolWays::join(const ToolWay& way) {
  if (count_ == 0 || at(count_ - 1).cutter != way.cutter) return false;
  return (at(count_ - 1).breaks == way.breaks || full()) && join(at(count_ - 1), way, full());
}

void ToolWays::drop_oldest() {
  first_ = (first_ + 1) % max_ways;
  --count_;
}

}  // namespace trephine::drill
