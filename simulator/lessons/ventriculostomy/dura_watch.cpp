// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/ventriculostomy/dura_watch.h"

#include <algorithm>

#include "haptics/haptic_state.h"

namespace trephine::lessons {

DuraWatch::DuraWatch(const cases::CaseManifest& manifest, std::optional<DuraFacts>& facts) {
  for (const cases::CaseShape& shape : manifest.haptic.shapes)
    if (shape.name == "dura") {
      shape_ = shape.number;
      bears_n_ = shape.material.front.pop_through_n;
      facts.emplace();
    }
}

void DuraWatch::tick(const haptics::ServoFrame& f, bool drilling, std::optional<DuraFacts>& facts) {
  if (!facts) return;
  // A tool that gives way is some millimetres farther in the same tick: what it left is what it touched before.
  if (held_ && f.events & haptics::haptic_event::popped) facts->pops.push_back(last_);
  held_ = f.touched == shape_;
  if (!held_ || !drilling) over_s_ = 0;
  if (!held_) return;
  const double force_n = norm(Vec3{f.force_n[0], f.force_n[1], f.force_n[2]});
  last_ = {f.time_s, {f.proxy_mm[0], f.proxy_mm[1], f.proxy_mm[2]}, force_n};
  if (!drilling) return;
  if (facts->burr_first_s < 0) facts->burr_first_s = f.time_s;
  facts->burr_s += f.dt_s;
  facts->burr_n = std::max(facts->burr_n, force_n);
  over_s_ = bears_n_ > 0 && force_n > bears_n_ ? over_s_ + f.dt_s : 0;
  if (!facts->breach && over_s_ >= breach_s - 1e-9) facts->breach = last_;
}

}  // namespace trephine::lessons
