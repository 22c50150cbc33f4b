// SPDX-License-Identifier: GPL-3.0-or-later
#include "drill/drill.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace trephine::drill {
namespace {

constexpr double largest_mm = 40;
constexpr int max_looked = 16000;  // voxels of which most are as they were

double size_of(const Cutter& c) {
  return c.kind == Cutter::Kind::ball ? 2 * c.radius_mm : std::max({2 * c.semi_a_mm, 2 * c.semi_b_mm, c.height_mm});
}

bool positive(const Cutter& c) {
  return c.kind == Cutter::Kind::ball ? c.radius_mm > 0 : c.semi_a_mm > 0 && c.semi_b_mm > 0 && c.height_mm > 0;
}

// Of the box of the cutter on a short way.
std::size_t voxels_in_reach(const Cutter& cutter, const grid::Lattice& l) {
  constexpr double max_way_mm = 10;
  double grown = 1;
  for (int a = 0; a < 3; ++a) grown *= (std::sqrt(2.0) * size_of(cutter) + max_way_mm) / l.spacing_mm[a] + 4;
  return std::size_t(std::min({grown, double(l.count()), 4e6}));
}

grid::Box box_around(const grid::Lattice& l, Vec3 middle_mm, double reach_mm) {
  const Vec3 m = l.to_index(middle_mm);
  grid::Box box;
  for (std::size_t a = 0; a < 3; ++a) {
    const double reach = reach_mm / l.spacing_mm[int(a)];
    box.begin[a] = int(std::clamp(std::ceil(m[int(a)] - reach), 0.0, double(l.size[a])));
    box.end[a] = int(std::clamp(std::floor(m[int(a)] + reach) + 1, 0.0, double(l.size[a])));
  }
  return box;
}

std::int64_t units_of(const Removal& r) {
  std::int64_t units = 0;
  for (const std::int64_t of_shape : r.units) units += of_shape;
  return units;
}

}  // namespace

Drill::Drill(voxel::HapticVolume& volume, const DrillShapes& shapes, const Cutter& cutter, const DrillParams& params,
             DirtyBricks* marks)
    : power_w_(params.power_w), lattice_(volume.voxels), voxels_(volume, shapes, params, marks), ways_(volume.voxels) {
  add_cutter(cutter);
  hold(0);
}

void Drill::add_cutter(const Cutter& cutter) {
  if (!positive(cutter) || !(size_of(cutter) <= largest_mm))
    throw Error(ExitCode::bad_config, "", "cutter", "must have a size above 0 and at most 40 mm");
  ways_.add_cutter(cutter);
  voxels_.make_room(voxels_in_reach(cutter, lattice_));
}

void Drill::hold(int number) {
  // One place is free for the first way of the cutter that comes, which goes on to no way of the one before.
  if (ways_.full()) ways_.join_any();
  held_ = number;
  rest();
}

const Removal& Drill::cut_way(const ToolPose& pose, Vec3 to_tip_mm, const Wider& wider, double dt_s,
                              double power_ratio) {
  voxels_.begin();
  ToolPose from = pose;
  // A tool that went less than half a voxel overlaps with where it was.
  const Vec3 s = lattice_.spacing_mm;
  if (const Vec3 was = tip_in(cutter(), pose.frame, end_);
      runs_ && norm(pose.tip_mm - was) > 0.5 * std::min({s.x, s.y, s.z}))
    from.tip_mm = was;
  end_ = {to_tip_mm, pose.frame};
  runs_ = true;
  const double energy_j = power_w_ * std::max(power_ratio, 0.0) * dt_s;
  if (!(energy_j > 0 && dt_s > 0)) return go_ways(dt_s);
  const ToolWay way{from, to_tip_mm, wider, dt_s, energy_j, 1, 0, held_, power_ratio > 1};
  if (!ways_.join(way)) {
    // Where the cutter was changed so often that no place became free, the oldest way is cut to its end first.
    while (ways_.full()) cut_pass();
    ways_.add(way);
  }
  return go_ways(dt_s);
}

const Removal& Drill::cut_late(double dt_s) {
  voxels_.begin();
  return go_ways(dt_s);
}

// As many passes as a call has time for.
const Removal& Drill::go_ways(double dt_s) {
  for (double left = ToolWays::pass_voxels; !ways_.empty() && left > 0;) {
    const double voxels = ways_.voxels_of(ways_.oldest()) / ways_.passes_of(ways_.oldest());
    if (left < ToolWays::pass_voxels && voxels > left) break;
    left -= voxels;
    cut_pass();
  }
  Removal& removed = voxels_.removed();
  removed.power_w = removed.energy_j / dt_s;
  return removed;
}

// The next pass of the oldest way, of every m-th slice of voxels. The energy of a way is shared by its passes.
void Drill::cut_pass() {
  const Vec3 s = lattice_.spacing_mm;
  const double gone_on = std::min({s.x, s.y, s.z});
  ToolWay& w = ways_.oldest();
  w.passes = ways_.passes_of(w);
  const std::int64_t before = units_of(voxels_.removed());
  voxels_.collect(CutterBody(ways_.cutter(w.cutter), w.from, w.to_tip_mm, w.wider, lattice_), w.time_s, w.pass,
                  w.passes);
  voxels_.cut(w.energy_j / w.passes);
  if (!runs_ || norm(w.to_tip_mm - end_.tip_mm) > gone_on)
    voxels_.removed().late_units += units_of(voxels_.removed()) - before;
  if (++w.pass >= w.passes) ways_.drop_oldest();
}

void Drill::incise(Vec3 point_mm, double radius_mm) {
  incision_ = {};
  incision_.middle_mm = point_mm;
  incision_.radius_mm = std::clamp(radius_mm, 0.0, 30.0);
  if (!is_finite(point_mm)) return;
  const grid::Box box = box_around(lattice_, point_mm, incision_.radius_mm);
  if (box.empty()) return;
  incision_.box = box;
  incision_.slice = box.begin[2];
  incision_.row = box.begin[1];
}

const Removal& Drill::go_on() {
  voxels_.begin();
  voxels_.go_on(incision_);
  return voxels_.removed();
}

void Drill::keep_steps(int max_steps) { voxels_.keep_steps(max_steps); }

int Drill::step_place() { return voxels_.log().steps() > 0 ? voxels_.log().place() : -1; }

void Drill::forget_what_is_due() {
  rest();
  ways_.clear();
  incision_ = {};
}

bool Drill::take_back() {
  if (putting_back()) return false;
  voxels_.log().end_step();
  if (voxels_.log().steps() == 0) return false;
  forget_what_is_due();
  back_ = Back::step;
  return true;
}

bool Drill::take_all_back(const grid::Grid<std::int16_t>& begin) {
  if (putting_back() || voxels_.ever().empty()) return false;
  forget_what_is_due();
  voxels_.log().clear();
  begin_ = &begin;
  back_slice_ = voxels_.ever().begin[2];
  back_row_ = voxels_.ever().begin[1];
  back_ = Back::all;
  return true;
}

const Removal& Drill::put_back() {
  voxels_.begin();
  bool nothing_left = false;
  if (back_ == Back::step) {
    const UndoLog::Part part = voxels_.log().take(VoxelRemoval::max_put_back);
    for (std::size_t n = 0; n < part.count; ++n)
      voxels_.put_back(part.first[n].at, part.first[n].raw, part.first[n].fraction);
    if (part.last) back_ = Back::none;
  } else if (back_ == Back::all) {
    const grid::Box& ever = voxels_.ever();
    const int across = ever.end[0] - ever.begin[0];
    for (int looked = 0; back_slice_ < ever.end[2] && looked < max_looked &&
                         (voxels_.put_back_count() == 0 ||
                          voxels_.put_back_count() + std::size_t(across) <= VoxelRemoval::max_put_back);
         looked += across) {
      for (int i = ever.begin[0]; i < ever.end[0]; ++i) {
        const std::size_t at = lattice_.index(i, back_row_, back_slice_);
        voxels_.put_back(std::uint32_t(at), begin_->voxels[at], 0);
      }
      if (++back_row_ < ever.end[1]) continue;
      back_row_ = ever.begin[1];
      ++back_slice_;
    }
    nothing_left = back_slice_ >= ever.end[2];
    if (nothing_left) back_ = Back::none;
  }
  voxels_.end_back(nothing_left);
  return voxels_.removed();
}

}  // namespace trephine::drill
