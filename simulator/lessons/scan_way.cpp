// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/scan_way.h"

#include <algorithm>
#include <cmath>

namespace trephine::lessons {

std::vector<Vec3> way_inwards(const std::vector<lesson::OutcomePlace>& course, Vec3 tip_mm) {
  std::vector<Vec3> all;
  for (std::size_t n = course.size(); n-- > 1;) {
    const Vec3 from = course[n].at_mm, to = course[n - 1].at_mm;
    const int steps = std::max(1, int(std::ceil(norm(to - from) / way_step_mm)));
    for (int k = 0; k < steps; ++k) all.push_back(from + (to - from) * (double(k) / steps));
  }
  all.push_back(tip_mm);
  return all;
}

int shape_about(const voxel::HapticDecoder& decoder, const cases::CaseHaptic& haptic, Vec3 place_mm) {
  for (const cases::CaseShape& shape : haptic.shapes)
    if (decoder.trilinear(shape.number, place_mm) >= 0.5) return shape.number;
  return 0;
}

}  // namespace trephine::lessons
