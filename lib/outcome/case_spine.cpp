// SPDX-License-Identifier: GPL-3.0-or-later
#include "outcome/case_spine.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace trephine::outcome {
namespace {

constexpr double below_pedicles_mm = 4;  ///< the middle of a vertebra lies below that of its pedicles
constexpr double reach_ratio = 0.62;     ///< of the pitch: farther from a level's middle is another vertebra

int number_of(const std::string& pedicle) {
  int number = 0;
  for (const char c : pedicle)
    if (c >= '0' && c <= '9') number = 10 * number + (c - '0');
  return number;
}

}  // namespace

bool is_spine(const cases::LoadedCase& loaded) {
  return loaded.has_haptic() && !loaded.haptic.find_shape("skull") && loaded.haptic.find_shape("bone") &&
         !cases::pedicles_of(loaded.manifest).empty();
}

CaseSpine::CaseSpine(const cases::LoadedCase& of)
    : loaded(of),
      decoder(of.haptic),
      bone(of.haptic.find_shape("bone")->number),
      pedicles(cases::pedicles_of(of.manifest)) {
  std::map<int, std::pair<Vec3, int>> sums;
  for (const cases::CasePedicle& p : pedicles) {
    auto& [sum, count] = sums[number_of(p.name)];
    sum += (p.entry_mm + p.target_mm) * 0.5;
    ++count;
  }
  for (const auto& [number, sum] : sums) levels.push_back({number, sum.first * (1.0 / sum.second)});
  if (levels.size() > 1) {
    const Vec3 way = levels.back().middle_mm - levels.front().middle_mm;
    cranial = normalized(way);
    pitch_mm = norm(way) / double(levels.size() - 1);
  } else {
    cranial = pedicles.front().cranial;
  }
  for (Level& l : levels) l.middle_mm = l.middle_mm - cranial * below_pedicles_mm;
}

int CaseSpine::level_of(Vec3 p) const {
  int best = -1;
  double nearest = reach_ratio * pitch_mm;
  for (std::size_t n = 0; n < levels.size(); ++n)
    if (const double off = std::abs(dot(p - levels[n].middle_mm, cranial)); off < nearest) nearest = off, best = int(n);
  return best;
}

int CaseSpine::level_of(const cases::CasePedicle& pedicle) const {
  for (std::size_t n = 0; n < levels.size(); ++n)
    if (levels[n].number == number_of(pedicle.name)) return int(n);
  return -1;
}

}  // namespace trephine::outcome
