// SPDX-License-Identifier: GPL-3.0-or-later
// Removal along the whole way of a tool, however fast it goes: what a tick has no time for, the next ones remove.
#include <algorithm>
#include <cmath>

#include "drill/cutter_body.h"
#include "drill/drill.h"

namespace trephine::drill {
namespace {

constexpr double straight_voxels = 0.25;  // how far a way may leave its chord
constexpr double max_turn = 0.02;         // of a cylinder on one way, rad
constexpr double longest_mm = 40;         // of ways that are made one

double length_of(const Cutter& c) { return c.kind == Cutter::Kind::ball ? 0 : c.height_mm; }
double width_of(const Cutter& c) {
  return 2 * (c.kind == Cutter::Kind::ball ? c.radius_mm : std::max(c.semi_a_mm, c.semi_b_mm));
}

std::int64_t units_of(const Removal& r) {
  std::int64_t units = 0;
  for (const std::int64_t of_shape : r.units) units += of_shape;
  return units;
}

// How far the frame of a way turns until another one, where that matters for what the cutter fills.
double turn_between(const Cutter& c, const Mat3& a, const Mat3& b) {
  if (c.kind == Cutter::Kind::ball) return 0;
  return norm(a.column[2] - b.column[2]) + (c.semi_a_mm == c.semi_b_mm ? 0 : norm(a.column[0] - b.column[0]));
}

// The same place of the cutter with another frame: of a ball the centre stays, of others the tip.
Vec3 tip_in(const Cutter& c, const Mat3& frame, const ToolPose& pose) {
  if (c.kind != Cutter::Kind::ball) return pose.tip_mm;
  return pose.tip_mm + (pose.frame.column[2] - frame.column[2]) * c.radius_mm;
}

}  // namespace

// How many voxels have to be looked at for a way: those of the box around it.
double Drill::voxels_of(const Way& way) const {
  const Vec3 s = volume_.voxels.spacing_mm;
  const Cutter& cutter = cutters_[std::size_t(way.cutter)];
  const double ramp = std::max({s.x, s.y, s.z}), radius = 0.5 * width_of(cutter) + way.wider_mm + ramp;
  const double length = norm(way.to_tip_mm - way.from.tip_mm) + length_of(cutter);
  return (M_PI * radius * radius * length + 4.0 / 3 * M_PI * radius * radius * radius) / voxel_mm3_;
}

// A pass looks at no more than some thousand voxels.
int Drill::passes_of(const Way& way) const {
  return std::clamp(int(std::ceil(voxels_of(way) / max_voxels)), 1, max_passes);
}

// Makes the way part of the last one, where that has not begun and goes on straight, or `always`. Both are of one
// cutter.
bool Drill::join(Way& last, const Way& way, bool always) {
  const Cutter& cutter = cutters_[std::size_t(last.cutter)];
  const Vec3 chord = way.to_tip_mm - last.from.tip_mm, middle = last.to_tip_mm - last.from.tip_mm;
  const double squared = dot(chord, chord);
  const double off =
      squared > 0 ? norm(middle - chord * std::clamp(dot(middle, chord) / squared, 0.0, 1.0)) : norm(middle);
  const Vec3 s = volume_.voxels.spacing_mm;
  const bool joins = off <= straight_voxels * std::min({s.x, s.y, s.z}) && squared <= longest_mm * longest_mm &&
                     turn_between(cutter, last.from.frame, way.from.frame) <= max_turn;
  if (last.pass != 0 || !(joins || always)) return false;
  last.from.tip_mm = tip_in(cutter, way.from.frame, last.from);
  last.from.frame = way.from.frame;
  last.to_tip_mm = way.to_tip_mm;
  last.wider_mm = std::max(last.wider_mm, way.wider_mm);
  last.time_s += way.time_s;
  last.energy_j += way.energy_j;
  return true;
}

// Makes one of the last two neighbours that one cutter went and that have not begun; none where there are none.
void Drill::join_any() {
  int n = ways_count_ - 1;
  while (n > 0 && !(way_at(n - 1).cutter == way_at(n).cutter && join(way_at(n - 1), way_at(n), true))) --n;
  if (n <= 0) return;
  for (; n + 1 < ways_count_; ++n) way_at(n) = way_at(n + 1);
  --ways_count_;
}

// Adds what the tool went in this tick, to the last way or as one more. Where the cutter was changed so often that no
// place became free, the oldest way is cut to its end first.
void Drill::add_way(const Way& way) {
  if (ways_count_ > 0) {
    Way& last = way_at(ways_count_ - 1);
    if (last.cutter == way.cutter && join(last, way, ways_count_ == max_ways)) return;
  }
  while (ways_count_ == max_ways) cut_pass();
  way_at(ways_count_++) = way;
}

const Removal& Drill::cut_way(const ToolPose& pose, Vec3 to_tip_mm, double wider_mm, double dt_s, double power_ratio) {
  out_ = {};
  ToolPose from = pose;
  // A tool that went less than half a voxel overlaps with where it was.
  const Vec3 s = volume_.voxels.spacing_mm;
  if (const Vec3 was = tip_in(cutter_, pose.frame, end_);
      runs_ && norm(pose.tip_mm - was) > 0.5 * std::min({s.x, s.y, s.z}))
    from.tip_mm = was;
  end_ = {to_tip_mm, pose.frame};
  runs_ = true;
  const double energy_j = params_.power_w * std::clamp(power_ratio, 0.0, 1.0) * dt_s;
  if (energy_j > 0 && dt_s > 0) add_way({from, to_tip_mm, wider_mm, dt_s, energy_j, 1, 0, held_});
  return go_ways(dt_s);
}

const Removal& Drill::cut_late(double dt_s) {
  out_ = {};
  return go_ways(dt_s);
}

// As many passes as a call has time for.
const Removal& Drill::go_ways(double dt_s) {
  for (double left = max_voxels; ways_count_ > 0 && left > 0;) {
    const double voxels = voxels_of(way_at(0)) / passes_of(way_at(0));
    if (left < max_voxels && voxels > left) break;
    left -= voxels;
    cut_pass();
  }
  out_.power_w = out_.energy_j / dt_s;
  return out_;
}

// The next pass of the oldest way, of every m-th slice of voxels. The energy of a way is shared by its passes.
void Drill::cut_pass() {
  const Vec3 s = volume_.voxels.spacing_mm;
  const double gone_on = std::min({s.x, s.y, s.z});
  Way& w = way_at(0);
  w.passes = passes_of(w);
  const std::int64_t before = units_of(out_);
  entries_.clear();
  collect(CutterBody(cutters_[std::size_t(w.cutter)], w.from, w.to_tip_mm, w.wider_mm, volume_.voxels), w.time_s,
          w.pass, w.passes);
  const double rate = rate_for(w.energy_j / w.passes);
  apply(rate * voxel::haptic_full * fine, false);
  if (!runs_ || norm(w.to_tip_mm - end_.tip_mm) > gone_on) out_.late_units += units_of(out_) - before;
  if (++w.pass < w.passes) return;
  first_way_ = (first_way_ + 1) % max_ways;
  --ways_count_;
}

}  // namespace trephine::drill
