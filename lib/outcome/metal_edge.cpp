// SPDX-License-Identifier: GPL-3.0-or-later
#include "outcome/metal_edge.h"

#include <algorithm>
#include <cmath>

#include "mask/filters.h"

namespace trephine::outcome {
namespace {

constexpr double bin_mm = 0.1, outside_mm = 1.5;
constexpr double cone_mm = 5, point_mm = 0.8;  ///< of a screw's tip: its length, and the radius of its end

/// The first and the last of some places, and the HU beyond the metal, which is what is usual at the last of them.
struct Extent {
  double first = 1e9, last = -1e9, around_hu = 0;
};
template <class V, class At, class Hu>
Extent extent_of(const std::vector<V>& voxels, const At& at, const Hu& hu) {
  Extent e;
  for (const V& v : voxels) e.first = std::min(e.first, at(v)), e.last = std::max(e.last, at(v));
  std::vector<float> outside;
  for (const V& v : voxels)
    if (at(v) > e.last - outside_mm) outside.push_back(float(hu(v)));
  e.around_hu = std::min(double(mask::median(outside, 0)), 1000.0);
  return e;
}

}  // namespace

std::optional<MetalEdge> metal_edge(const std::vector<std::pair<double, double>>& hu_at, double metal, double most) {
  if (hu_at.size() < 12) return {};
  const auto [first, last, around] = extent_of(
      hu_at, [](const auto& v) { return v.first; }, [](const auto& v) { return v.second; });
  struct Bin {
    double sum = 0, count = 0;
  };
  std::vector<Bin> bins(std::size_t((last - first) / bin_mm) + 1);
  for (const auto& [at, hu] : hu_at) {
    Bin& bin = bins[std::size_t((at - first) / bin_mm)];
    bin.sum += std::min(most, hu), ++bin.count;
  }
  MetalEdge best;
  double least = 1e30;
  for (double blur = 0.3; blur < 2.05; blur += 0.1)
    for (double edge = first; edge < last; edge += 0.05) {
      double cost = 0;
      for (std::size_t n = 0; n < bins.size(); ++n) {
        if (bins[n].count == 0) continue;
        const double x = first + (double(n) + 0.5) * bin_mm - edge;
        const double share = 0.5 * std::erfc(x / blur / std::sqrt(2.0));
        const double d = std::min(most, around + (metal - around) * share) - bins[n].sum / bins[n].count;
        cost += bins[n].count * d * d;
      }
      if (cost < least) least = cost, best = {edge, blur};
    }
  return best;
}

std::optional<double> tip_end(const std::vector<AxisVoxel>& core, double radius_mm, double slice_mm,
                              const std::pair<double, double>& metal) {
  if (core.size() < 12) return {};
  const auto [first, last, around] = extent_of(
      core, [](const AxisVoxel& v) { return v.along_mm; }, [](const AxisVoxel& v) { return v.hu; });
  const auto share = [&](double inside_mm, double off_mm) {
    if (inside_mm < 0) return 0.0;
    const double r = std::min(radius_mm, point_mm + (radius_mm - point_mm) * inside_mm / cone_mm), half = slice_mm / 2;
    return std::max(0.0, std::min(off_mm + half, r) - std::max(off_mm - half, -r)) / slice_mm;
  };
  double best = first, least = 1e30;
  for (double blur = 0.3; blur < 1.6; blur += 0.2)
    for (double end = first; end < last; end += 0.05) {
      double cost = 0;
      for (const AxisVoxel& v : core) {
        const double in = end - v.along_mm, wide = std::sqrt(3.0) * blur;  // the blur by three places
        const double metal_share =
            (share(in - wide, v.slice_mm) + share(in + wide, v.slice_mm)) / 6 + share(in, v.slice_mm) * 2 / 3;
        const double d =
            std::min(metal.second, around + (metal.first - around) * metal_share) - std::min(metal.second, v.hu);
        cost += d * d;
      }
      if (cost < least) least = cost, best = end;
    }
  return best;
}

}  // namespace trephine::outcome
