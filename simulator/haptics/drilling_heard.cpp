// SPDX-License-Identifier: GPL-3.0-or-later
// What a drill does beside removing bone: it warms it, and is heard.
#include "haptics/drilling.h"

namespace trephine::haptics {

void Drilling::feel_heat(bool runs, double dt_s) {
  heat_.step(removed_j_ / dt_s, runs, dt_s);
  outcome_.max_bone_c = heat_.max_c();
  outcome_.above_harm_s = heat_.above_harm_s();
  outcome_.heat_dose_min = heat_.dose_min();
}

Drilling::Heard Drilling::heard() const {
  return {runs_.load(std::memory_order_relaxed), stalls_.load(std::memory_order_relaxed),
          double(load_.load(std::memory_order_relaxed)), double(hardness_.load(std::memory_order_relaxed)),
          burrs_[std::size_t(burr_.load(std::memory_order_relaxed))].flutes};
}

}  // namespace trephine::haptics
