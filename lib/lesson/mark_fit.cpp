// SPDX-License-Identifier: GPL-3.0-or-later
#include "lesson/mark_fit.h"

#include <algorithm>
#include <cmath>

namespace trephine::lesson {
namespace {

/// Which place each mark is, and how they lie.
struct Matching {
  RigidFit rigid;
  std::vector<Vec3> from, to;
  std::vector<std::size_t> places;
};
Matching matched(const std::vector<Vec3>& marks, const std::vector<Vec3>& found, const MarkTolerance& tolerance) {
  Matching best;
  const auto extend = [&](const RigidMap& start) {
    RigidMap map = start;
    Matching now;
    for (int round = 0; round < 3; ++round) {
      now.from.clear(), now.to.clear(), now.places.clear();
      for (const Vec3& m : marks) {
        const Vec3 p = map(m);
        const auto nearest =
            std::min_element(found.begin(), found.end(), [&](Vec3 a, Vec3 b) { return norm(a - p) < norm(b - p); });
        if (nearest == found.end() || norm(*nearest - p) > tolerance.mark_mm) continue;
        now.from.push_back(m), now.to.push_back(*nearest);
        now.places.push_back(std::size_t(nearest - found.begin()));
      }
      if (now.from.size() < 3) return;
      now.rigid = fit_rigid(now.from, now.to);
      map = now.rigid.map;
    }
    if (now.from.size() > best.from.size() ||
        (now.from.size() == best.from.size() && now.rigid.rms_mm < best.rigid.rms_mm))
      best = now;
  };
  const std::size_t n = marks.size(), m = found.size();
  const auto apart = [&](std::size_t i, std::size_t j, std::size_t a, std::size_t b) {
    return std::abs(norm(found[i] - found[j]) - norm(marks[a] - marks[b])) <= tolerance.pair_mm;
  };
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t b = a + 1; b < n; ++b)
      for (std::size_t i = 0; i < m; ++i)
        for (std::size_t j = 0; j < m; ++j) {
          if (i == j || !apart(i, j, a, b)) continue;
          for (std::size_t c = b + 1; c < n; ++c)
            for (std::size_t k = 0; k < m; ++k)
              if (k != i && k != j && apart(k, i, c, a) && apart(k, j, c, b))
                extend(fit_rigid({marks[a], marks[b], marks[c]}, {found[i], found[j], found[k]}).map);
        }
  return best;
}

}  // namespace

MarkFit match_marks(const std::vector<PrintMark>& marks, const std::vector<Vec3>& found,
                    const MarkTolerance& tolerance) {
  std::vector<Vec3> known, mirror;
  for (const PrintMark& m : marks) {
    known.push_back(m.case_mm);
    mirror.push_back({-m.case_mm.x, m.case_mm.y, m.case_mm.z});
  }
  const Matching is = matched(known, found, tolerance), other = matched(mirror, found, tolerance);
  MarkFit fit;
  fit.map = is.rigid.map;
  fit.marks = is.from.size();
  fit.residual_mm = is.rigid.rms_mm;
  fit.used_mm = is.from;
  fit.found_mm = is.to;
  fit.places = is.places;
  fit.mirrored_marks = other.from.size();
  if (!other.from.empty()) fit.mirrored_residual_mm = other.rigid.rms_mm;
  return fit;
}

}  // namespace trephine::lesson
