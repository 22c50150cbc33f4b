// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/spine/pedicle_errors.h"

#include <algorithm>
#include <cmath>

#include "voxel/decode.h"

namespace trephine::lessons {
namespace {

constexpr double after_entry_mm = 4;  // nearer to the entry the wall is the surface that the needle enters by
constexpr double farthest_wall_mm = 40, walk_mm = 0.2;
constexpr int directions = 12;
constexpr double at_mm = 10;  // of its entry: a pass whose line passes farther away is not at that pedicle

// Where a line from the tip along the axis passes the plane through `at` across `normal`.
Vec3 passes(Vec3 tip, Vec3 axis, Vec3 at, Vec3 normal) {
  const double slope = dot(axis, normal);
  if (std::abs(slope) < 0.05) return tip;  // nearly along the plane: it passes nowhere near
  return tip + axis * (dot(at - tip, normal) / slope);
}

// From the axis to its wall that way; a vessel's hole of a millimetre is none.
double wall_mm(const voxel::HapticDecoder& volume, int bone, Vec3 from, Vec3 way) {
  double last = 0;
  for (double t = 0; t < farthest_wall_mm && t - last < 1; t += walk_mm)
    if (volume.trilinear(bone, from + way * t) >= 0.5) last = t;
  return last;
}

constexpr const char* wall_names[] = {"medial", "lateral", "upper", "lower"};

PedicleBreach::Wall side_of(const CasePedicle& p, Vec3 way) {
  const double o = dot(way, p.outer()), u = dot(way, p.up());
  if (std::abs(u) > std::abs(o)) return u > 0 ? PedicleBreach::upper : PedicleBreach::lower;
  return o > 0 ? PedicleBreach::lateral : PedicleBreach::medial;
}

}  // namespace

NeedleErrors needle_errors(const CasePedicle& p, Vec3 tip, Vec3 axis) {
  const Vec3 f = p.forwards();
  NeedleErrors e;
  e.pedicle = &p;
  e.entry_off = passes(tip, axis, p.entry_mm, f) - p.entry_mm;
  e.target_off = passes(tip, axis, p.target_mm, f) - p.target_mm;
  e.entry_mm = norm(e.entry_off);
  e.target_mm = norm(e.target_off);
  e.depth_mm = dot(tip - p.target_mm, f);
  e.turned_deg = std::acos(std::clamp(-dot(axis, f), -1.0, 1.0)) * 180 / M_PI;
  return e;
}

NeedleErrors nearest_pedicle(const std::vector<CasePedicle>& pedicles, Vec3 tip, Vec3 axis) {
  NeedleErrors best;
  for (const CasePedicle& p : pedicles) {
    const NeedleErrors e = needle_errors(p, tip, axis);
    if (!best.pedicle || e.entry_mm < best.entry_mm) best = e;
  }
  return best;
}

NeedleErrors errors_at(const std::vector<CasePedicle>& pedicles, const std::string& task, Vec3 tip, Vec3 axis) {
  for (const CasePedicle& p : pedicles)
    if (p.name == task) return needle_errors(p, tip, axis);
  return nearest_pedicle(pedicles, tip, axis);
}

DeepestTip deepest_tip(const CasePedicle& pedicle, const std::vector<NeedlePass>& passes) {
  DeepestTip most;
  for (const NeedlePass& pass : passes)
    for (const NeedlePoint& n : pass.path)
      if (const NeedleErrors e = needle_errors(pedicle, n.tip_mm, n.axis);
          e.entry_mm <= at_mm && e.depth_mm > most.beyond_mm)
        most = {e.depth_mm, n.time_s};
  return most;
}

double pedicle_width_mm(const CasePedicle& p, const voxel::HapticVolume& volume, int bone) {
  const Vec3 f = p.forwards(), outer = p.outer();
  const voxel::HapticDecoder decoder(volume);
  double least = 0;
  const double length = norm(p.target_mm - p.entry_mm);
  for (double t = after_entry_mm; t < length; t += 0.5) {
    const Vec3 at = p.entry_mm + f * t;
    const double width = wall_mm(decoder, bone, at, outer) + wall_mm(decoder, bone, at, -outer);
    if (width > 0 && (least == 0 || width < least)) least = width;
  }
  return least;
}

PedicleBreach find_breach(const CasePedicle& p, const NeedlePass& pass, const voxel::HapticVolume& volume, int bone) {
  const Vec3 f = p.forwards();
  const double length = norm(p.target_mm - p.entry_mm);
  const Vec3 up = p.up(), across = cross(up, f);
  const voxel::HapticDecoder decoder(volume);
  PedicleBreach worst;
  const auto look = [&](Vec3 at, double time_s) {
    const double along = dot(at - p.entry_mm, f);
    if (along < after_entry_mm || along > length) return;
    const Vec3 on_axis = p.entry_mm + f * along;
    for (int n = 0; n < directions; ++n) {  // each side of the needle
      const double turn = 2 * M_PI * n / directions;
      const Vec3 off = at - on_axis + (across * std::cos(turn) + up * std::sin(turn)) * (0.5 * pass.diameter_mm);
      const double off_mm = norm(off);
      if (!(off_mm > 1e-6)) continue;
      const double beyond = off_mm - wall_mm(decoder, bone, on_axis, off / off_mm);
      const PedicleBreach::Wall wall = side_of(p, off);
      const char* const side = wall_names[wall];
      worst.walls_mm[wall] = std::max(worst.walls_mm[wall], beyond);
      if (beyond > worst.depth_mm) worst.depth_mm = beyond, worst.side = side, worst.at_mm = at, worst.time_s = time_s;
      if (wall == PedicleBreach::medial)
        worst.medial_mm = std::max(worst.medial_mm, beyond);
      else if (beyond > worst.other_mm)
        worst.other_mm = beyond, worst.other_side = side, worst.other_s = time_s;
    }
  };
  for (const NeedlePoint& n : pass.path) look(n.tip_mm, n.time_s);
  if (!pass.path.empty()) {
    const NeedlePoint& last = pass.path.back();
    for (double t = 0; t < std::min(length + 40, pass.length_mm); t += 0.5)
      look(last.tip_mm + last.axis * t, last.time_s);
  }
  // Less than the volume's own step is none.
  if (worst.depth_mm < 0.5 * volume.voxels.spacing_mm.x) worst = {};
  return worst;
}

PedicleBreach breach_in_place(const CasePedicle& pedicle, const NeedlePass& pass, const voxel::HapticVolume& volume,
                              int bone) {
  NeedlePass end = pass;
  end.path = {pass.path.back()};
  return find_breach(pedicle, end, volume, bone);
}

int gertzbein_grade(const PedicleBreach& breach) {
  if (!(breach.depth_mm > 0)) return 0;
  return breach.depth_mm < 2 ? 1 : breach.depth_mm < 4 ? 2 : breach.depth_mm < 6 ? 3 : 4;
}

}  // namespace trephine::lessons
