// SPDX-License-Identifier: GPL-3.0-or-later
#include "haptics/drilling.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/joined.h"
#include "haptics/force_slew.h"
#include "haptics/tool_belt.h"

namespace trephine::haptics {
namespace {

constexpr double slowness_s = 0.005;    // time constant of the filters on velocity and power
constexpr double half_speed_mm_s = 20;  // of the tool, at which half of the reaction is felt
constexpr double min_depth_mm = 1;      // of a way through bone that counts as a breach

// Of a bite in a tick; of what a cutter may be wider than its tool; how fast it becomes wider where it uses less than
// that share of its power, and how much slower it becomes narrower again.
constexpr double max_bite_voxels = 0.4, max_wider_voxels = 1, widening_voxels_per_s = 40, narrowing = 0.3, breaking = 4,
                 idle_ratio = 0.6;
constexpr double for_shaft_voxels = 0.15;  // how much wider, at most, for a shaft that is as wide as its cutter
constexpr double across_counts_n = 0.1;    // less is the drill's own swing
constexpr double breaking_w = 1e4;         // so that nothing of what breaks is left by the power
constexpr double usual_height_mm = 8;      // of a cylinder, where the tool's kind says nothing

// "a, b or c".
std::string kinds_that_cut() {
  std::vector<std::string> names;
  for (const ToolKind& kind : all_tool_kinds())
    if (kind.cuts()) names.push_back(kind.name);
  return listed(names, "or");
}

bool is_bone(const drill::DrillShape& shape) { return shape.cuttable && shape.energy_j_per_mm3 > 0; }

std::uint64_t bone_of(const drill::DrillShapes& shapes) {
  std::uint64_t bits = 0;
  for (std::size_t n = 1; n < shapes.size(); ++n)
    if (is_bone(shapes[n])) bits |= std::uint64_t{1} << n;
  return bits;
}

double radius_of(const drill::Cutter& c) { return c.kind == drill::Cutter::Kind::ball ? c.radius_mm : c.semi_a_mm; }

double smooth(double value, double to, double dt_s) { return value + (to - value) * dt_s / (dt_s + slowness_s); }

}  // namespace

drill::DrillShapes drill_shapes_of(const cases::CaseHaptic& haptic) {
  drill::DrillShapes out;
  for (const cases::CaseShape& s : haptic.shapes)
    if (s.number >= 1 && s.number <= voxel::haptic_max_shapes)
      out[std::size_t(s.number)] = {s.cuttable, s.material.removal_energy_j_per_mm3};
  return out;
}

std::uint64_t drilled_shapes(const cases::CaseHaptic& haptic) { return bone_of(drill_shapes_of(haptic)); }

drill::Cutter cutter_of(const DrillingParams& params, const ToolParams& tool) {
  drill::Cutter c;
  const ToolKind& kind = tool_kind(tool.tool);
  if (kind.cut == ToolKind::Cut::incision) {  // it only incises: FeltCase::drilling_of gives it no shape to drill
    c.radius_mm = 0.5;
    return c;
  }
  if (!kind.cuts())
    throw Error(ExitCode::usage, "", "--drill", "needs --tool " + kinds_that_cut() + ", not " + tool.tool);
  const bool rounded = params.cutter == DrillingParams::Cutter::own && kind.cut == ToolKind::Cut::rounded;
  const bool ball = params.cutter == DrillingParams::Cutter::own ? kind.cut == ToolKind::Cut::ball
                                                                 : params.cutter == DrillingParams::Cutter::ball;
  c.kind = ball ? drill::Cutter::Kind::ball : drill::Cutter::Kind::cylinder;
  c.radius_mm = c.semi_a_mm = 0.5 * tool.tool_diameter_mm;
  c.semi_b_mm = c.semi_a_mm * params.cutter_width_ratio;
  c.height_mm = params.cutter_height_mm > 0 ? params.cutter_height_mm
                : kind.cutting_mm > 0       ? kind.cutting_mm
                                            : usual_height_mm;
  if (rounded) {
    c.round_end = true;
    c.semi_b_mm = c.semi_a_mm;
    c.height_mm = std::max(c.height_mm, c.semi_a_mm);
  }
  return c;
}

Drilling::Drilling(voxel::HapticVolume& volume, contact::ContactVolume& contact, const drill::DrillShapes& shapes,
                   const DrillingParams& params, const drill::DrillParams& law, const drill::Cutter& cutter,
                   drill::DirtyBricks* marks)
    : Drilling(volume, contact, shapes, params, law, std::vector<Burr>(1, Burr{cutter}), marks) {}

Drilling::Drilling(voxel::HapticVolume& volume, contact::ContactVolume& contact, const drill::DrillShapes& shapes,
                   const DrillingParams& params, const drill::DrillParams& law, std::vector<Burr> burrs,
                   drill::DirtyBricks* marks)
    : contact_(contact),
      params_(params),
      burrs_(std::move(burrs)),
      power_w_(law.power_w),
      shapes_(shapes),
      before_(voxel::copy_without_hardness(volume)),
      before_decoder_(before_),
      drill_(volume, shapes, burrs_.front().cutter, law, marks),
      heat_(params, radius_of(burrs_.front().cutter)),
      voxel_mm3_(volume.voxels.voxel_volume_mm3()),
      letting_go_(contact, bone_of(shapes), params.rim_strength_n_per_mm2, ForceSlew::max_n_per_ms) {
  for (const Burr& b : burrs_) letting_go_.add(b.cutter);
  for (std::size_t n = 1; n < burrs_.size(); ++n) drill_.add_cutter(burrs_[n].cutter);
  measure_burr();
  stands_.resize(std::size_t(params.undo_steps));
  if (params.undo_steps > 0) drill_.keep_steps(int(params.undo_steps));
}

// What follows from the width of the burr in hand.
void Drilling::measure_burr() {
  const double radius_mm = radius_of(burrs_[std::size_t(burr_)].cutter);
  least_pass_units_ = M_PI * radius_mm * radius_mm / 4 * min_depth_mm / voxel_mm3_ * voxel::haptic_full;
  rim_m_per_s_ = params_.spindle_rpm / 60 * 2 * M_PI * radius_mm / 1000;
  heat_.set_radius(radius_mm);
  ramp_voxels_ = drill::ramp_voxels(burrs_[std::size_t(burr_)].cutter, before_.voxels);
}

void Drilling::hold(int burr) {
  if (burr == burr_) return;
  burr_ = burr;
  drill_.hold(burr);
  letting_go_.hold(burr);
  measure_burr();
  wider_voxels_ = 0;
}

void Drilling::count(const drill::Removal& r, bool breaks) {
  if (r.changed.empty()) return;
  contact_.loosen(r.changed);
  if (!breaks) {  // what breaks away takes none
    outcome_.energy_j += r.energy_j;
    removed_j_ += r.energy_j;
  }
  outcome_.late_units += r.late_units;
  for (std::size_t n = 1; n < r.units.size(); ++n) {
    outcome_.units[n] += r.units[n];
    if (shapes_[n].energy_j_per_mm3 > 0) pass_units_ += r.units[n];
    if (shapes_[n].energy_j_per_mm3 > 0) removed_mm3_ += double(r.units[n]) / voxel::haptic_full * voxel_mm3_;
    removed_[n].store(outcome_.units[n], std::memory_order_relaxed);
  }
}

drill::ToolPose Drilling::turned_pose(Vec3 tip_mm, Vec3 axis, Vec3 across) const {
  drill::ToolPose pose;
  pose.tip_mm = tip_mm;
  pose.frame = frame_of(axis, usable_across(across, axis));
  if (params_.cutter_turn_deg == 0) return pose;
  const double a = params_.cutter_turn_deg * M_PI / 180;
  const Vec3 u = pose.frame.column[0], v = pose.frame.column[1];
  pose.frame.column[0] = u * std::cos(a) + v * std::sin(a);
  pose.frame.column[1] = v * std::cos(a) - u * std::sin(a);
  return pose;
}

// The drill does not run; what is late is removed all the same.
void Drilling::cut_late(double dt_s) {
  drill_.rest();
  if (drill_.late()) count(drill_.cut_late(dt_s));
}

// About the places that hold the tool; on all sides where that is not enough and where the tip is in no bone, and a
// little for a shaft that follows.
drill::Wider Drilling::wider(const HapticState& state) const {
  const double voxel_mm = contact_.smallest_side_mm();
  if (!in_bone_ || letting_go_.is_through() || letting_go_.breaks()) return wider_voxels_ * voxel_mm;
  const drill::Cutter& c = drill_.cutter();
  const bool shaft_follows = c.kind == drill::Cutter::Kind::cylinder && !c.round_end;
  drill::Wider w = voxel_mm * std::max(shaft_follows ? std::min(wider_voxels_, for_shaft_voxels) : 0.0,
                                       2 * wider_voxels_ - max_wider_voxels);
  w.held_mm = wider_voxels_ * voxel_mm;
  w.places = state.held_at;
  for (int n = 0; n < w.places; ++n) w.at_mm[n] = {state.held_mm[n][0], state.held_mm[n][1], state.held_mm[n][2]};
  return w;
}

// The cutter where the tool is shown. It bites as far as the tool is pressed, at most half a voxel, and takes the power
// that the pressure allows: the force along the feed is reaction_ratio times power by the speed of the rim. What holds
// the tool is always cut: where a pressed tool finds nothing to remove, because discs and voxels are coarser than its
// own surface, it cuts a little wider there until it does.
double Drilling::cut(const HapticInput& in, const HapticState& state) {
  const double voxel_mm = contact_.smallest_side_mm();
  const bool on_mesh = touch::is_mesh(state.touched);  // which no drill cuts
  const bool pressed = state.touched != 0 && !on_mesh && is_bone(shapes_[std::size_t(state.touched)]);
  const double pressure = pressed ? norm(state.force_n - force_) : 0;
  if (pressure >= params_.stall_force_n) {
    outcome_.stalled_s += in.dt_s;
    cut_late(in.dt_s);  // it does not cut on this way
    return 0;
  }
  double max_w = power_w_;
  if (pressed && params_.reaction_ratio > 0) max_w = std::min(max_w, pressure * rim_m_per_s_ / params_.reaction_ratio);
  // Also where what lies behind the bone holds the tool already.
  const bool breaks = state.touched != 0 && letting_go_.breaks();
  if (breaks) max_w = breaking_w;
  Vec3 bite = on_mesh ? Vec3{} : in.tip_mm - state.proxy_mm;
  const double most_mm = std::min(max_bite_voxels * voxel_mm, breaks ? letting_go_.most_mm() : 1e9);
  if (const double length = norm(bite); length > most_mm) bite = bite * (most_mm / length);
  const drill::Removal& r = drill_.cut_way(turned_pose(state.proxy_mm, state.axis, state.across), state.proxy_mm + bite,
                                           wider(state), in.dt_s, max_w / power_w_);
  const bool idle = (pressed || breaks) && r.power_w < idle_ratio * std::min(max_w, power_w_);
  // Less stands beside a narrow cutter while bone breaks: it would be through before its force is gone.
  const double widens = letting_go_.is_loose() ? breaking : breaks ? 2 * ramp_voxels_ - 1 : 1;
  const double change = (idle ? widens : -narrowing) * widening_voxels_per_s * in.dt_s;
  wider_voxels_ = std::clamp(wider_voxels_ + change, 0.0, max_wider_voxels);
  count(r, breaks);
  return breaks ? 0 : r.power_w;
}

void Drilling::prepare(HapticInput& in) const {
  in.extra_n = in.extra_n == Vec3{} ? force_ : in.extra_n + force_;
  in.drilling = in.buttons & pedal;
  in.breached = came_through_;
  in.giving_way = letting_go_.breaks() ? letting_go_.bone() : 0;
  in.held_ratio = letting_go_.ratio();
  in.away = putting_back();
}

void Drilling::tick(const HapticInput& in, const HapticState& state) {
  time_s_ += in.dt_s;
  came_through_ = false;
  if (state.faults != 0) {
    force_ = {};
    last_mm_ = in.tip_mm;  // where the fault passes, it goes on from there
    drill_.rest();
    return;
  }
  if (drill_.putting_back()) return put_back(in.buttons);
  if (state.touched != 0) {
    double& most = outcome_.most_force_n[std::size_t(state.touched)];
    most = std::max(most, norm(state.force_n));
  }
  const bool lifted = in.buttons & haptic_button::lifted;  // the tool is not where the pose is, and cuts nothing
  if (!begun_ || lifted) last_mm_ = in.tip_mm;
  const Vec3 velocity = (in.tip_mm - last_mm_) / in.dt_s;
  for (int a = 0; a < 3; ++a) velocity_[a] = smooth(velocity_[a], velocity[a], in.dt_s);
  const Vec3 step_mm = in.tip_mm - last_mm_;
  last_mm_ = in.tip_mm;

  double used_w = 0;
  removed_j_ = removed_mm3_ = 0;
  const double stalled_s = outcome_.stalled_s;
  if ((in.buttons & pedal) && !(buttons_ & pedal)) begin_step();
  if ((in.buttons & pedal) && !lifted) {
    used_w = cut(in, state);
    outcome_.drilled_s += in.dt_s;
    since_cut_s_ = removed_mm3_ > 0 ? 0 : since_cut_s_ + in.dt_s;
    if (since_cut_s_ < 0.02) {
      outcome_.cutting_s += in.dt_s;
      outcome_.cutting_n_s += norm(state.force_n) * in.dt_s;
      outcome_.advanced_mm -= dot(step_mm, in.axis);
    }
  } else {
    cut_late(in.dt_s);
  }
  if ((in.buttons & mark) && !(buttons_ & mark)) incise_at(in.tip_mm);
  const int command = belt_button::command(in.buttons);
  if (command != belt_button::command(buttons_) && !(in.buttons & pedal)) {
    if (command == belt_command::undo) take_back(Back::last);
    if (command == belt_command::reset) take_back(Back::all);
  }
  buttons_ = in.buttons;
  begun_ = true;
  if (drill_.incising()) count(drill_.go_on());
  // A tool that has come through rests on what lies behind the bone, at its very border: half a voxel ahead tells.
  const Vec3 spacing = before_.voxels.spacing_mm;
  const double ahead_mm = std::min({spacing.x, spacing.y, spacing.z}) / 2;
  watch_breach(in, state.proxy_mm - in.axis * ahead_mm);
  let_go(in, state);

  const bool runs = (in.buttons & pedal) && !lifted;
  feel_heat(runs, in.dt_s);
  runs_.store(runs, std::memory_order_relaxed);
  stalls_.store(outcome_.stalled_s > stalled_s, std::memory_order_relaxed);
  load_.store(float(std::min(1.0, used_w / power_w_)), std::memory_order_relaxed);
  hardness_.store(removed_mm3_ > 0 ? float(removed_j_ / removed_mm3_) : 0, std::memory_order_relaxed);

  // The force at the rim is the power divided by the rim's speed.
  power_ = smooth(power_, std::min(used_w, power_w_), in.dt_s);
  const double reaction = params_.reaction_ratio * power_ / rim_m_per_s_, speed = norm(velocity_);
  force_ = velocity_ * (-reaction / (speed + half_speed_mm_s));
  const double swing = params_.vibration_n * power_ / power_w_ * std::sin(2 * M_PI * params_.vibration_hz * time_s_);
  force_ += frame_along(in.axis).column[0] * swing;
}

bool Drilling::was_bone(Vec3 at) const {
  return std::any_of(before_.shapes.begin(), before_.shapes.end(), [&](const voxel::HapticShape& s) {
    return is_bone(shapes_[std::size_t(s.number)]) && before_decoder_.trilinear(s.number, at) >= 0.5;
  });
}

// A breach is a way through bone from its outside that a drill made: at least min_depth_mm deep, and on it as much bone
// was removed as such a hole of half the cutter's width holds. So a tool that passes through its own hole again
// breaches nothing. A way that the tool leaves with its pedal up ends there, and begins anew where it comes back, so a
// hole that is drilled in two goes is one breach.
void Drilling::watch_breach(const HapticInput& in, Vec3 tip) {
  const bool runs = in.buttons & pedal, lifted = in.buttons & haptic_button::lifted;
  const bool is = !lifted && was_bone(tip);
  if (is && !in_bone_ && !letting_go_.is_through()) {  // else it is in again by the way on which it came through
    entry_mm_ = tip;
    pass_units_ = 0;
  }
  if (!is && in_bone_ && dot(entry_mm_ - tip, in.axis) <= min_depth_mm) letting_go_.rest();
  if (runs && !lifted && !is && in_bone_ && dot(entry_mm_ - tip, in.axis) > min_depth_mm) {
    const bool first = !outcome_.breached;
    // One that was left before it was free, and through which the tool now goes on, is still due.
    due_ = first || double(pass_units_) > least_pass_units_ ||
           (due_ && norm(tip - due_mm_) < radius_of(burrs_[std::size_t(burr_)].cutter));
    due_mm_ = tip;
    letting_go_.come_through();
    if (first) {
      outcome_.breached = true;
      outcome_.breach_time_s = time_s_;
      outcome_.breach_mm = tip;
    }
  }
  in_bone_ = is;
}

// The breach is told once nothing of the bone is left under the cutter. Bone at which the drill stops, and other bone
// that its tip meets behind, hold it as before.
void Drilling::let_go(const HapticInput& in, const HapticState& state) {
  const bool runs = (in.buttons & pedal) && !(in.buttons & haptic_button::lifted);
  if (in.buttons & haptic_button::lifted) return letting_go_.rest();
  if (!runs || in_bone_) return letting_go_.hold_again();
  // Along the tool: a cutter that widens its hole with the tip out mills the wall, which stands.
  const Vec3 force = state.force_n - force_;
  const double along_n = dot(force, state.axis), across_n = norm(force - state.axis * along_n);
  if (across_n > std::max(along_n, across_counts_n)) return letting_go_.hold_again();
  if (!letting_go_.look(turned_pose(state.proxy_mm, state.axis, state.across), std::max(along_n, 0.0), in.dt_s)) return;
  came_through_ = due_;
  due_ = false;
}

}  // namespace trephine::haptics
