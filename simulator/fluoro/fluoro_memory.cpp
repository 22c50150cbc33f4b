// SPDX-License-Identifier: GPL-3.0-or-later
#include "fluoro/fluoro_memory.h"

#include <algorithm>
#include <utility>

namespace trephine::fluoro {

bool same_arm(const CArmParams& a, const CArmParams& b) {
  return a.view == b.view && a.orbit_deg == b.orbit_deg && a.tilt_deg == b.tilt_deg && a.centre_mm == b.centre_mm &&
         a.source_to_centre_mm == b.source_to_centre_mm && a.source_to_detector_mm == b.source_to_detector_mm &&
         a.detector_mm == b.detector_mm;
}

const KeptFluoro* FluoroMemory::find(const CArmParams& arm, int size) {
  const auto found = std::find_if(kept_.begin(), kept_.end(), [&](const KeptFluoro& k) {
    return k.integrals.size == size && same_arm(k.arm, arm);
  });
  if (found == kept_.end()) return nullptr;
  kept_.splice(kept_.begin(), kept_, found);
  return &kept_.front();
}

const KeptFluoro& FluoroMemory::keep(KeptFluoro picture) {
  kept_.remove_if(
      [&](const KeptFluoro& k) { return k.integrals.size <= picture.integrals.size && same_arm(k.arm, picture.arm); });
  kept_.push_front(std::move(picture));
  while (kept_.size() > 1 && (kept_.size() > max_places_ || bytes() > max_bytes_)) kept_.pop_back();
  return kept_.front();
}

std::size_t FluoroMemory::bytes() const {
  std::size_t sum = 0;
  for (const KeptFluoro& k : kept_) sum += k.integrals.integral.size() * sizeof(float);
  return sum;
}

}  // namespace trephine::fluoro
