// SPDX-License-Identifier: GPL-3.0-or-later
#include "outcome/fit_vertebrae.h"

#include <algorithm>
#include <cmath>

namespace trephine::outcome {
namespace {

constexpr double points_mm = 3;
constexpr double least_overlap = 0.2;  ///< of the vertebrae's bone: with less a shift is none to compare with
constexpr double alike_ratio = 1.15;
constexpr int farthest_shift = 3;  ///< levels

using Groups = std::vector<std::vector<BonePoint>>;

/// All vertebrae, from one map of the whole.
struct Chain {
  std::vector<BoneFit> of_level;
  double residual_mm = 1e9, overlap_ratio = 0, matched_ratio = 0;
  std::size_t points = 0;
};
Chain chained(const Groups& groups, const ScanView& scan, const itk::LinearMap& from) {
  Chain out;
  out.of_level.resize(groups.size());
  const auto fitted = [&](std::size_t n, const itk::LinearMap& start) {
    out.of_level[n] = refined_fit(groups[n], scan, start);
    return out.of_level[n].overlap_ratio >= SpineFit::least_seen ? out.of_level[n].map : start;
  };
  const std::size_t middle = groups.size() / 2;
  const itk::LinearMap at_middle = fitted(middle, from);
  itk::LinearMap map = at_middle;
  for (std::size_t n = middle + 1; n < groups.size(); ++n) map = fitted(n, map);
  map = at_middle;
  for (std::size_t n = middle; n-- > 0;) map = fitted(n, map);
  double sum = 0, weight = 0, all = 0, within = 0;
  for (std::size_t n = 0; n < groups.size(); ++n) {
    const BoneFit& f = out.of_level[n];
    all += double(groups[n].size());
    if (f.overlap_ratio < SpineFit::least_seen) continue;
    const double w = f.overlap_ratio * double(groups[n].size());
    sum += w * f.residual_mm * f.residual_mm;
    weight += w;
    within += w;
    out.points += f.points;
  }
  if (weight > 0) out.residual_mm = std::sqrt(sum / weight), out.matched_ratio = double(out.points) / within;
  out.overlap_ratio = within / std::max(1.0, all);
  return out;
}

/// The best of all shifts by levels, and the next.
struct Shifted {
  Chain best;
  double next_residual_mm = 1e9;
};
Shifted best_shift(const CaseSpine& spine, const Groups& groups, const ScanView& scan, const itk::LinearMap& from,
                   const Progress& progress) {
  std::vector<Chain> all;
  for (int shift = -farthest_shift; shift <= farthest_shift; ++shift) {
    progress.report(double(shift + farthest_shift) / (2 * farthest_shift + 1));
    const itk::LinearMap start = itk::then({Mat3(), spine.cranial * (shift * spine.pitch_mm)}, from);
    Chain c = chained(groups, scan, start);
    if (c.overlap_ratio < least_overlap) continue;
    all.push_back(std::move(c));
  }
  Shifted out;
  std::stable_sort(all.begin(), all.end(),
                   [](const Chain& a, const Chain& b) { return a.residual_mm < b.residual_mm; });
  if (all.empty()) return out;
  out.best = all.front();
  for (const Chain& c : all)  // where vertebrae are all alike, as many of them as can be
    if (c.residual_mm < alike_ratio * all.front().residual_mm && c.overlap_ratio > out.best.overlap_ratio) out.best = c;
  // Two shifts may slide to the same place: another one lies a good part of a level off.
  const std::size_t middle = groups.size() / 2;
  const auto place = [&](const Chain& c) { return c.of_level[middle].map(spine.levels[middle].middle_mm); };
  for (const Chain& c : all)
    if (norm(place(c) - place(out.best)) > 0.4 * spine.pitch_mm)
      out.next_residual_mm = std::min(out.next_residual_mm, c.residual_mm);
  return out;
}

}  // namespace

std::optional<SpineFit> fit_vertebrae(const CaseSpine& spine, const ScanView& scan, const Progress& progress) {
  const std::vector<BonePoint> points = bone_points(spine.loaded.haptic, spine.bone, points_mm);
  const std::vector<BonePoint> mirror = mirrored(points);
  SpineFit out;
  Groups mirrored_groups(spine.levels.size());
  out.points.resize(spine.levels.size());
  for (std::size_t n = 0; n < points.size(); ++n)
    if (const int level = spine.level_of(points[n].at_mm); level >= 0) {
      out.points[std::size_t(level)].push_back(points[n]);
      mirrored_groups[std::size_t(level)].push_back(mirror[n]);
    }
  std::vector<double> up_mm;
  for (int shift = -farthest_shift; shift <= farthest_shift; ++shift) up_mm.push_back(shift * spine.pitch_mm);
  const auto fit = fit_bone(points, scan, progress.part(0, 0.3), up_mm);
  if (!fit) return {};
  out.all = *fit;
  const Shifted best = best_shift(spine, out.points, scan, fit->map, progress.part(0.3, 0.6));
  out.of_level = best.best.of_level;
  if (out.of_level.empty()) return {};
  out.residual_mm = best.best.residual_mm;
  out.overlap_ratio = best.best.overlap_ratio;
  out.matched_ratio = best.best.matched_ratio;
  out.points_count = best.best.points;
  out.next_level_residual_mm = best.next_residual_mm;
  out.all = refined_fit(points, scan, out.of_level[out.of_level.size() / 2].map);
  if (const auto other = fit_bone(mirror, scan, progress.part(0.6, 0.8), up_mm))
    out.mirrored_residual_mm =
        best_shift(spine, mirrored_groups, scan, other->map, progress.part(0.8, 1)).best.residual_mm;
  return out;
}

}  // namespace trephine::outcome
