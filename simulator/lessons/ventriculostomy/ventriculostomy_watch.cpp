// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/ventriculostomy/ventriculostomy_watch.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "base/error.h"

namespace trephine::lessons {
namespace {

constexpr double lift_s = 0.3, lift_mm = 5;  // a marker that leaves the skin for less goes on with its trace
constexpr double path_step_mm = 0.25;        // of a catheter's way
constexpr double look_each_s = 0.25;         // while the burr runs
constexpr double site_mm = 20;               // nearer to where the burr began it is the same hole

Vec3 vec(const double* v) { return {v[0], v[1], v[2]}; }

haptics::BeltToolParams tool_of(const char* name, const char* kind) {
  haptics::BeltToolParams t;
  t.name = name;
  t.tool = kind;
  static_cast<haptics::ToolParams&>(t) = haptics::own_tool(t);
  return t;
}

// What is neither blunt nor cuts nor draws goes into the brain.
bool is_catheter(const haptics::BeltToolParams& t) { return !t.blunt && !t.marks && !t.cuts; }

}  // namespace

std::vector<haptics::BeltToolParams> ventriculostomy_tools() {
  haptics::BeltToolParams marker = tool_of("marker", "marker"), burr = tool_of("burr", "ball"),
                          catheter = tool_of("catheter", "catheter");
  marker.blunt = marker.marks = true;
  burr.blunt = burr.cuts = true;
  std::vector<haptics::BeltToolParams> all = {marker, burr, catheter};
  for (const char* name : {"suction", "irrigation"}) {
    all.push_back(tool_of(name, name));
    all.back().blunt = true;
  }
  // Further burrs, each a tool named by its kind and width.
  for (const auto& [name, kind, width_mm] : {std::tuple{"burr", "ball", 3},
                                             {"burr", "ball", 4},
                                             {"burr", "ball", 6},
                                             {"burr", "ball", 7},
                                             {"burr_diamond", "diamond", 3},
                                             {"burr_diamond", "diamond", 5}}) {
    haptics::BeltToolParams other = burr;
    other.name = std::string(name) + "_" + std::to_string(width_mm);
    static_cast<haptics::ToolParams&>(other) = {};
    other.tool = kind;
    other.tool_diameter_mm = width_mm;
    static_cast<haptics::ToolParams&>(other) = haptics::own_tool(other);
    all.push_back(other);
  }
  return all;
}

HeadShapes head_shapes_of(const cases::CaseManifest& manifest) {
  HeadShapes s;
  for (const cases::CaseShape& shape : manifest.haptic.shapes) {
    if (shape.name == "skin") s.skin = shape.number;
    if (shape.name == "brain") s.brain = shape.number;
    if (shape.name == "ventricles") s.ventricles = shape.number;
    if (shape.material.removal_energy_j_per_mm3 > 0 && s.bone == 0) s.bone = shape.number;
  }
  if (s.bone == 0 || s.brain == 0 || s.ventricles == 0)
    throw Error(ExitCode::bad_input, "", "haptic.shapes", "the lesson needs bone, brain and ventricles that are felt");
  return s;
}

const char* name_of(LessonPhase phase) {
  constexpr const char* names[] = {"marking", "drilling", "catheter", "review"};
  return names[int(phase)];
}

Ventriculostomy::Ventriculostomy(const cases::CaseManifest& manifest, const voxel::HapticVolume& before,
                                 const voxel::HapticVolume& now)
    : manifest_(manifest),
      before_(before),
      now_(now),
      frame_(head_frame_of(manifest)),
      shapes_(head_shapes_of(manifest)),
      dura_(manifest, facts_.dura) {
  facts_.hole = find_case_hole(manifest, {});
  facts_.drilled_beforehand = facts_.hole.has_value();
}

LessonPhase Ventriculostomy::phase() const {
  if (facts_.end != LessonEnd::running) return LessonPhase::review;
  if (facts_.drilled_beforehand || facts_.through_s >= 0) return LessonPhase::catheter;
  return facts_.incisions.empty() ? LessonPhase::marking : LessonPhase::drilling;
}

void Ventriculostomy::begin(const haptics::ServoFrame&, const haptics::ToolBelt& belt) {
  for (const haptics::BeltToolParams& t : belt.tools())
    if (is_catheter(t)) facts_.catheter_mm = t.tool_diameter_mm;
}

void Ventriculostomy::tick(const haptics::ServoFrame& f, const haptics::ToolBelt& belt, bool pedal) {
  const haptics::BeltToolParams& tool = belt.tools()[std::size_t(belt.in_hand())];
  draw(f, pedal && tool.marks);
  drill(f, belt, pedal && tool.cuts);
  dura_.tick(f, pedal && tool.cuts, facts_.dura);
  const bool catheter = is_catheter(tool);
  if (in_brain_ && (!catheter || (f.inside == 0 && taken_away(f, belt, last_tip_.tip_mm)))) end_pass(f.time_s, false);
  if (catheter && !belt.paused()) pass(f);
}

void Ventriculostomy::command(int command, const haptics::ServoFrame& f, const haptics::ToolBelt& belt) {
  if (command == haptics::belt_command::erase)
    for (MarkerTrace& t : facts_.traces) t.erased = true;
  if (command == haptics::belt_command::incise && belt.can_cut() && belt.has_mark())
    facts_.incisions.push_back({f.time_s, belt.mark_mm()});
}

void Ventriculostomy::draw(const haptics::ServoFrame& f, bool pedal) {
  if (!pedal) return end_trace();
  const Vec3 at = vec(f.proxy_mm);
  if (f.touched == 0) {
    if (drawing_ && f.time_s - last_touch_s_ > lift_s) end_trace();
    return;
  }
  if (drawing_ && norm(at - facts_.traces.back().points_mm.back()) > lift_mm) end_trace();
  last_touch_s_ = f.time_s;
  if (!drawing_) {
    drawing_ = true;
    facts_.traces.emplace_back();
    facts_.traces.back().begin_s = f.time_s;
    facts_.traces.back().points_mm.push_back(at);
  }
  MarkerTrace& t = facts_.traces.back();
  t.end_s = f.time_s;
  const double step = norm(at - t.points_mm.back());
  if (step < trace_step_mm) return;
  t.length_mm += step;
  t.points_mm.push_back(at);
}

void Ventriculostomy::end_trace() { drawing_ = false; }

// The holes of a stroke that goes on belong together; elsewhere another one begins.
void Ventriculostomy::note_site(const haptics::ServoFrame& f) {
  const Vec3 at = vec(f.tip_mm);
  for (HoleSite& site : sites_)
    if (norm(site.at_mm - at) < site_mm) {
      site.out += vec(f.axis);
      return;
    }
  sites_.push_back({at, vec(f.axis), f.time_s});
}

void Ventriculostomy::drill(const haptics::ServoFrame& f, const haptics::ToolBelt& belt, bool pedal) {
  if (!belt.can_cut()) return;
  if (pedal) {
    facts_.drill_s += f.dt_s;
    if (facts_.drill_begin_s < 0) facts_.drill_begin_s = f.time_s;
    note_site(f);
    const Vec3 index = now_.voxels.to_index(vec(f.tip_mm));
    const Vec3 s = now_.voxels.spacing_mm;
    const bool first = drilled_box_.empty();
    const int reach = int(std::ceil(20 / std::min({s.x, s.y, s.z}))) + 2;  // no cutter is wider than 40 mm
    for (int a = 0; a < 3; ++a) {
      const int at = int(std::lround(std::clamp(index[a], -1e6, 1e6)));
      const std::size_t n = std::size_t(a);
      drilled_box_.begin[n] = first ? at - reach : std::min(drilled_box_.begin[n], at - reach);
      drilled_box_.end[n] = first ? at + reach + 1 : std::max(drilled_box_.end[n], at + reach + 1);
    }
  }
  const std::int64_t removed = belt.removed_units(shapes_.bone);
  if (pedal && removed > removed_units_)
    facts_.burr_mm =
        std::max(facts_.burr_mm, haptics::own_tool(belt.tools()[std::size_t(belt.in_hand())]).tool_diameter_mm);
  if (removed == 0) facts_.burr_mm = 0;  // all was taken back
  const bool stroke_ends = drilling_ && !pedal && removed != removed_units_at_note_;
  removed_units_ = removed;
  const bool due = pedal ? f.time_s - looked_s_ > look_each_s : drilling_;
  drilling_ = pedal;
  if (due && removed_units_ != looked_units_) look_for_hole(f.time_s, facts_.catheter_mm);
  if (stroke_ends) note_holes();
}

HoleSearch Ventriculostomy::search() const {
  HoleSearch search;
  search.bone = shapes_.bone;
  search.ball_mm = facts_.catheter_mm;
  search.box = grid::grown(drilled_box_, 0, now_.voxels);
  search.sites = sites_;
  return search;
}

void Ventriculostomy::look_for_hole(double time_s, double ball_mm) {
  looked_s_ = time_s;
  looked_units_ = removed_units_;
  if (facts_.drilled_beforehand) return;
  // A hole that is open stays open; what comes after may be another one, or make it wider.
  HoleSearch one = search();
  one.ball_mm = ball_mm;
  if (!facts_.passes.empty()) one.near_mm = facts_.passes.back().entry_mm;
  facts_.hole = find_drilled_hole(before_, now_, one);
  if (facts_.hole && facts_.hole->through && facts_.through_s < 0) facts_.through_s = time_s;
}

// What is drilled now, in place of what grew into it; what was taken back stays noted.
void Ventriculostomy::note_holes() {
  removed_units_at_note_ = removed_units_;
  std::vector<BoneHole> now = find_drilled_holes(before_, now_, search());
  now.erase(std::remove_if(now.begin(), now.end(), [](const BoneHole& h) { return h.removed_mm3 < scratch_mm3; }),
            now.end());
  for (const BoneHole& old : facts_.holes)
    if (std::none_of(now.begin(), now.end(), [&](const BoneHole& h) {
          const Vec3 d = old.outer_mm - h.outer_mm;
          return norm(d - h.out * dot(d, h.out)) <= std::max(h.radius_mm, old.radius_mm);
        }))
      now.push_back(old);
  facts_.holes = std::move(now);
}

void Ventriculostomy::pass(const haptics::ServoFrame& f) {
  const Vec3 tip = vec(f.proxy_mm);
  const bool inside = f.inside == shapes_.brain || f.inside == shapes_.ventricles;
  // The tip pops through by some millimetres: it entered where it was held before.
  const Vec3 before = held_tip_;
  held_tip_ = tip;
  if (!in_brain_) {
    if (!inside) return;
    in_brain_ = true;
    CatheterPass p;
    p.begin_s = p.end_s = f.time_s;
    p.entry_mm = f.events & haptics::haptic_event::popped ? before : tip;
    p.out = vec(f.axis);
    facts_.passes.push_back(p);
  }
  CatheterPass& p = facts_.passes.back();
  p.end_s = f.time_s;
  if (f.inside == shapes_.ventricles && p.csf_s < 0) p.csf_s = f.time_s;
  if (p.path.empty() || p.path.back().inside != f.inside || norm(tip - p.path.back().tip_mm) >= path_step_mm)
    p.path.push_back({f.time_s, tip, f.inside});
  last_tip_ = {f.time_s, tip, f.inside};
  // In sulci and cisterns it is in nothing, and still in the brain.
  if (!inside && dot(tip - p.entry_mm, p.out) > -withdrawn_mm) end_pass(f.time_s, false);
}

void Ventriculostomy::end_pass(double time_s, bool in_place) {
  if (!in_brain_) return;
  in_brain_ = false;
  CatheterPass& p = facts_.passes.back();
  p.end_s = time_s;
  p.in_place = in_place;
  if (in_place) p.path.push_back(last_tip_);
}

void Ventriculostomy::close() {
  end_trace();
  if (drilling_ && removed_units_ != looked_units_) look_for_hole(facts_.end_s, facts_.catheter_mm);
  if (drilling_ && removed_units_ != removed_units_at_note_) note_holes();
  drilling_ = false;
  end_pass(facts_.end_s, true);
  // Of several holes the one that the catheter went through.
  if (facts_.passes.empty()) return;
  if (facts_.drilled_beforehand)
    facts_.hole = find_case_hole(manifest_, facts_.passes.back().entry_mm);
  else if (removed_units_ > 0)
    look_for_hole(facts_.end_s, facts_.catheter_mm);
}

}  // namespace trephine::lessons
