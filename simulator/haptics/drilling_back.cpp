// SPDX-License-Identifier: GPL-3.0-or-later
// Strokes and incisions as steps that are taken back.
#include "haptics/drilling.h"

namespace trephine::haptics {

Drilling::Stand Drilling::stand() const {
  return {outcome_.units, outcome_.incisions,     outcome_.breached,  in_bone_,
          pass_units_,    outcome_.breach_time_s, outcome_.breach_mm, entry_mm_};
}

void Drilling::go_back_to(const Stand& s) {
  outcome_.units = s.units;
  outcome_.incisions = s.incisions;
  outcome_.breached = s.breached;
  outcome_.breach_time_s = s.breach_time_s;
  outcome_.breach_mm = s.breach_mm;
  in_bone_ = s.in_bone;
  letting_go_.rest();
  due_ = false;
  pass_units_ = s.pass_units;
  entry_mm_ = s.entry_mm;
  for (std::size_t n = 1; n < outcome_.units.size(); ++n)
    removed_[n].store(outcome_.units[n], std::memory_order_relaxed);
}

void Drilling::begin_step() {
  if (stands_.empty()) return;
  drill_.begin_step();
  if (const int place = drill_.step_place(); place >= 0) stands_[std::size_t(place)] = stand();
}

void Drilling::incise_at(Vec3 point_mm) {
  if (drill_.putting_back()) return;
  begin_step();
  drill_.incise(point_mm, params_.incision_radius_mm);
  ++outcome_.incisions;
}

bool Drilling::take_back(Back what) {
  if (stands_.empty()) return false;
  if (what == Back::all) {
    if (!drill_.take_all_back(before_.voxels)) return false;
    back_to_ = {};
    ++outcome_.resets;
  } else {
    if (!drill_.take_back()) return false;
    back_to_ = stands_[std::size_t(drill_.step_place())];
    ++outcome_.undone;
  }
  putting_back_.store(true, std::memory_order_relaxed);
  return true;
}

void Drilling::put_back(std::uint32_t buttons) {
  buttons_ = buttons & ~pedal;  // one that is down at the end begins a stroke
  force_ = {};
  power_ = 0;
  begun_ = false;
  runs_.store(false, std::memory_order_relaxed);
  load_.store(0, std::memory_order_relaxed);
  const drill::Removal& r = drill_.put_back();
  if (!r.changed.empty()) contact_.loosen(r.changed);
  if (drill_.putting_back()) return;
  go_back_to(back_to_);
  putting_back_.store(false, std::memory_order_relaxed);
}

}  // namespace trephine::haptics
