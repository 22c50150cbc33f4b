// SPDX-License-Identifier: GPL-3.0-or-later
#include "mask/motion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/parallel.h"
#include "mask/filters.h"

namespace trephine::mask {
namespace {

constexpr double lower_hu = 200, upper_hu = 1000;  ///< bone: apparatus has little of it
constexpr double min_bone_mm2 = 1500;              ///< of a slice: a skull's ring
constexpr double reach_mm = 12, shift_step_mm = 0.25;
constexpr double least_mm = 1.5, max_slice_mm = 3;
constexpr int around = 8,
              beside = 2;           ///< slices on either side: that say how the outlines change; that the step touches
constexpr double spreads = 6;       ///< a step is that many times their spread
constexpr double fits_ratio = 0.5;  ///< of the misfit without the step, at most
constexpr double lasting_ratio = 1.3;  ///< of the step: it is seen from two slices

/// The bone of a slice, added up along its rows and along its columns, each with a sum of 1.
struct Profiles {
  std::array<std::vector<float>, 2> along;
  bool is = false;
};

std::vector<Profiles> profiles_of(const grid::HuVolume& volume, const Progress& progress) {
  const grid::Lattice& l = grid::lattice_of(volume);
  std::vector<Profiles> all(std::size_t(l.size[2]));
  std::visit(
      [&](const auto& g) {
        parallel_for(0, l.size[2], 1, [&](std::int64_t k, std::int64_t) {
          progress.check();
          Profiles& p = all[std::size_t(k)];
          for (int a = 0; a < 2; ++a) p.along[a].assign(std::size_t(l.size[a]), 0);
          double sum = 0;
          const auto* v = g.voxels.data() + std::size_t(k) * l.size[0] * l.size[1];
          for (int j = 0; j < l.size[1]; ++j)
            for (int i = 0; i < l.size[0]; ++i, ++v) {
              if (!(*v > lower_hu)) continue;
              const float bone = float((std::min(double(*v), upper_hu) - lower_hu) / (upper_hu - lower_hu));
              p.along[0][std::size_t(i)] += bone;
              p.along[1][std::size_t(j)] += bone;
              sum += bone;
            }
          p.is = sum * l.spacing_mm.x * l.spacing_mm.y >= min_bone_mm2;
          for (auto& line : p.along)
            for (float& f : line) f = float(f / std::max(sum, 1e-9));
        });
      },
      volume);
  return all;
}

/// How badly b, moved back by `shift` voxels, fits a.
double misfit(const std::vector<float>& a, const std::vector<float>& b, double shift) {
  const int whole = int(std::floor(shift)), n = int(a.size());
  const double part = shift - whole;
  const auto at = [&](int i) { return i >= 0 && i < n ? double(b[std::size_t(i)]) : 0.0; };
  double sum = 0;
  for (int i = 0; i < n; ++i) {
    const double off = (1 - part) * at(i + whole) + part * at(i + whole + 1) - a[std::size_t(i)];
    sum += off * off;
  }
  return sum;
}

double best_shift_mm(const std::vector<float>& a, const std::vector<float>& b, double spacing_mm) {
  double best = 0, least = misfit(a, b, 0);
  for (double s = -reach_mm; s <= reach_mm; s += shift_step_mm)
    if (const double m = misfit(a, b, s / spacing_mm); m < least) least = m, best = s;
  return best;
}

/// Along one axis of the slices: the shift from each slice's neighbour below to that above, where both show a skull. So
/// a slice in which the head moves is passed over.
class Shifts {
 public:
  Shifts(const std::vector<Profiles>& slices, int axis, double spacing_mm, const Progress& progress)
      : slices_(slices), axis_(axis), spacing_mm_(spacing_mm), all_(slices.size()) {
    parallel_for(0, std::int64_t(slices.size()), 1, [&](std::int64_t k, std::int64_t) {
      progress.check();
      if (has(int(k))) all_[std::size_t(k)] = best_shift_mm(before(int(k)), after(int(k)), spacing_mm_);
    });
  }

  /// How far the shift at k is from that of the slices around; 0 where that is no step.
  double step_at(int k) const {
    if (!has(k)) return 0;
    std::vector<float> others;
    for (int n = k - around; n <= k + around; ++n)
      if (std::abs(n - k) > beside && has(n)) others.push_back(float(all_[std::size_t(n)]));
    if (int(others.size()) < around) return 0;
    const double usual = median(others, 0.f);
    for (float& o : others) o = std::abs(o - float(usual));
    const double spread = median(others, 0.f), step = all_[std::size_t(k)] - usual;
    if (std::abs(step) < std::max(least_mm, spreads * spread)) return 0;
    // A single slice that lies elsewhere makes a step there, and one back.
    double sum = 0;
    for (int n = k - beside; n <= k + beside; ++n) sum += has(n) ? all_[std::size_t(n)] - usual : 0;
    if (sum / step < lasting_ratio) return 0;
    const double with = misfit(before(k), after(k), all_[std::size_t(k)] / spacing_mm_);
    return with <= fits_ratio * misfit(before(k), after(k), usual / spacing_mm_) ? step : 0;
  }

 private:
  bool has(int k) const {
    return k >= 1 && k + 1 < int(slices_.size()) && slices_[std::size_t(k - 1)].is && slices_[std::size_t(k + 1)].is;
  }
  const std::vector<float>& before(int k) const { return slices_[std::size_t(k - 1)].along[axis_]; }
  const std::vector<float>& after(int k) const { return slices_[std::size_t(k + 1)].along[axis_]; }

  const std::vector<Profiles>& slices_;
  int axis_;
  double spacing_mm_;
  std::vector<double> all_;
};

}  // namespace

std::optional<Motion> find_motion(const grid::HuVolume& volume, const Progress& progress) {
  const grid::Lattice& l = grid::lattice_of(volume);
  if (l.spacing_mm.z > max_slice_mm) return {};
  const std::vector<Profiles> slices = profiles_of(volume, progress);
  const Shifts x(slices, 0, l.spacing_mm.x, progress), y(slices, 1, l.spacing_mm.y, progress);
  std::optional<Motion> found;
  for (int k = 0; k < l.size[2]; ++k) {
    const Vec3 step{x.step_at(k), y.step_at(k), 0};
    const double beyond_is_above = l.direction.column[2].z < 0 ? -1 : 1;
    const Vec3 by = l.direction * step * beyond_is_above;
    if (norm(by) <= (found ? norm(found->by_mm) : 0)) continue;
    found = Motion{by, l.to_world_mm({(l.size[0] - 1) / 2.0, (l.size[1] - 1) / 2.0, double(k)})};
  }
  return found;
}

bool lies_between(const Motion& motion, const grid::Lattice& slices, Vec3 a_mm, Vec3 b_mm, double near_mm) {
  const auto above_mm = [&](Vec3 p) {
    return (slices.to_index(p).z - slices.to_index(motion.at_mm).z) * slices.spacing_mm.z;
  };
  const double a = above_mm(a_mm), b = above_mm(b_mm);
  return std::min(std::abs(a), std::abs(b)) <= near_mm || (a > 0) != (b > 0);
}

}  // namespace trephine::mask
