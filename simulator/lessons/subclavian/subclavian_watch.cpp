// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/subclavian/subclavian_watch.h"

#include <algorithm>

namespace trephine::lessons {
namespace {

constexpr double path_step_mm = 0.25;

Vec3 vec(const double* v) { return {v[0], v[1], v[2]}; }

}  // namespace

std::vector<haptics::BeltToolParams> subclavian_tools() {
  haptics::BeltToolParams needle;
  needle.name = "needle";
  needle.tool = "needle";
  static_cast<haptics::ToolParams&>(needle) = haptics::own_tool(needle);
  return {needle};
}

Subclavian::Subclavian(const cases::CaseManifest& manifest, const voxel::HapticVolume& before)
    : shapes_(chest_shapes_of(manifest)) {
  const ChestFrame frame = chest_frame_of(before, shapes_);
  facts_.notch_mm = frame.notch_mm;
  std::copy(frame.clavicle_mm, frame.clavicle_mm + 2, facts_.clavicle_mm);
}

void Subclavian::tick(const haptics::ServoFrame& f, const haptics::ToolBelt& belt, bool) {
  const Vec3 tip = vec(f.proxy_mm);
  if (in_ && f.inside == 0 && taken_away(f, belt, last_.tip_mm)) end_pass(f.time_s, false);
  if (belt.paused()) return;
  // The tip pops through by some millimetres: it entered where it was held before.
  const Vec3 before = held_tip_;
  held_tip_ = tip;
  facts_.inside = f.inside;
  if (!in_) {
    if (f.inside == 0) return;
    in_ = true;
    deepest_mm_ = 0;
    VeinPass& p = facts_.passes.emplace_back();
    p.begin_s = f.time_s;
    p.entry_mm = p.tip_mm = f.events & haptics::haptic_event::popped ? before : tip;
    p.out = vec(f.axis);
  }
  VeinPass& p = facts_.passes.back();
  p.end_s = f.time_s;
  if (p.path.empty() || p.path.back().inside != f.inside || norm(tip - p.path.back().tip_mm) >= path_step_mm)
    p.path.push_back({f.time_s, tip, f.inside});
  last_ = {f.time_s, tip, f.inside};
  if (const double depth = dot(p.entry_mm - tip, p.out); depth > deepest_mm_) {
    deepest_mm_ = depth;
    p.tip_mm = tip;
  }
  const std::pair<int, double*> first[] = {{shapes_.vein, &facts_.vein_s},
                                           {shapes_.artery, &facts_.artery_s},
                                           {shapes_.pleura, &facts_.pleura_s},
                                           {shapes_.lung, &facts_.lung_s}};
  for (const auto& [shape, time_s] : first)
    if (shape != 0 && f.inside == shape && *time_s < 0) *time_s = f.time_s;
  if (f.inside != shapes_.vein) facts_.blood_s = -1;
  if (f.inside != 0 && f.inside == shapes_.artery) facts_.syringe = lesson::Fluid::arterial_blood;
  if (f.inside != 0 && (f.inside == shapes_.pleura || f.inside == shapes_.lung)) facts_.syringe = lesson::Fluid::air;
  // Between two shapes it is in nothing, and still in the patient.
  if (f.inside == 0 && dot(tip - p.entry_mm, p.out) > -withdrawn_mm) end_pass(f.time_s, false);
}

void Subclavian::command(int command, const haptics::ServoFrame& f, const haptics::ToolBelt&) {
  if (command != haptics::belt_command::aspirate) return;
  facts_.aspirations.push_back({f.time_s, vec(f.proxy_mm), f.inside});
  if (f.inside == shapes_.vein) facts_.syringe = lesson::Fluid::venous_blood;
  if (f.inside == shapes_.vein) facts_.blood_s = f.time_s;
}

void Subclavian::end_pass(double time_s, bool in_place) {
  if (!in_) return;
  in_ = false;
  VeinPass& p = facts_.passes.back();
  p.end_s = time_s;
  p.in_place = in_place;
  if (in_place) p.path.push_back(last_);
}

}  // namespace trephine::lessons
