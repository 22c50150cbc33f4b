// SPDX-License-Identifier: GPL-3.0-or-later
#include "segmentation/speed_image.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/parallel.h"
#include "base/refusal.h"
#include "mask/filters.h"
#include "mask/hu_view.h"
#include "segmentation/tissue_mixture.h"

namespace trephine::segmentation {
namespace {

/// f(index of the first voxel, one beyond the last, slice) for every slice, in parallel.
template <class F>
void for_slices(const grid::Lattice& l, const Progress& progress, F&& f) {
  parallel_for(0, l.size[2], 1, [&](std::int64_t from, std::int64_t to) {
    progress.check();
    for (int k = int(from); k < int(to); ++k) f(l.index(0, 0, k), l.index(0, 0, k + 1), k);
  });
}

struct Extent {
  float least = std::numeric_limits<float>::infinity(), most = -std::numeric_limits<float>::infinity();
  std::size_t count = 0, positive = 0;
};

/// Of the voxels that count.
Extent extent_of(const grid::Grid<float>& g, const grid::Mask& counts, const Progress& progress) {
  std::vector<Extent> slices(g.size[2]);
  for_slices(g, progress, [&](std::size_t from, std::size_t to, int k) {
    Extent& e = slices[k];
    for (std::size_t v = from; v < to; ++v) {
      if (!counts.voxels[v]) continue;
      e.least = std::min(e.least, g.voxels[v]);
      e.most = std::max(e.most, g.voxels[v]);
      ++e.count;
      e.positive += g.voxels[v] > 0;
    }
  });
  Extent all;
  for (const Extent& e : slices) {
    all.least = std::min(all.least, e.least);
    all.most = std::max(all.most, e.most);
    all.count += e.count;
    all.positive += e.positive;
  }
  return all;
}

/// tanh, at once where it is 1 in float.
float sigmoid(float x) { return x > 9.5f ? 1.f : x < -9.5f ? -1.f : std::tanh(x); }

void regions(grid::Grid<float>& g, const grid::Mask& counts, const PresegmentParams& p, const Progress& progress) {
  const bool lower = p.sides != PresegmentSides::upper, upper = p.sides != PresegmentSides::lower;
  double range = p.smooth_range_hu;
  if (range == 0 && lower && upper) range = p.upper_hu - p.lower_hu;
  if (range == 0) {
    const Extent e = extent_of(g, counts, progress);
    range = (double(e.most) - e.least) / 3;
    if (!(range > 0))
      throw refusal(
          "volume",
          fmt::format("every voxel of the region is {} HU, a threshold tells nothing: it is constant", e.most),
          {"move or widen `roi_min_mm` and `roi_max_mm`, or take another series"});
  }
  const double e = std::pow(10, -p.smoothness);
  const float k = float(std::log((2 - e) / e) / range), low = float(p.lower_hu), high = float(p.upper_hu);
  for_slices(g, progress, [&](std::size_t from, std::size_t to, int) {
    for (std::size_t v = from; v < to; ++v) {
      const float x = g.voxels[v];
      g.voxels[v] = (lower ? sigmoid((x - low) * k) : 0.f) + (upper ? sigmoid((high - x) * k) : 0.f) -
                    (lower && upper ? 1.f : 0.f);
    }
  });
}

void edges(grid::Grid<float>& g, const grid::Mask& counts, const PresegmentParams& p, PresegmentResult& result,
           const Progress& progress) {
  mask::gaussian(g, p.edge_sigma_mm, progress);
  grid::Grid<float> steepness(static_cast<const grid::Lattice&>(g));
  const Vec3 h = g.spacing_mm;
  for_slices(g, progress, [&](std::size_t, std::size_t, int k) {
    const auto slope = [&](int a, int i, int j, double spacing) {
      int lo[3] = {i, j, k}, hi[3] = {i, j, k};
      lo[a] = std::max(0, lo[a] - 1);
      hi[a] = std::min(g.size[a] - 1, hi[a] + 1);
      const int span = hi[a] - lo[a];
      return span ? (g.at(hi[0], hi[1], hi[2]) - g.at(lo[0], lo[1], lo[2])) / float(span * spacing) : 0.f;
    };
    for (int j = 0; j < g.size[1]; ++j)
      for (int i = 0; i < g.size[0]; ++i) {
        const float x = slope(0, i, j, h.x), y = slope(1, i, j, h.y), z = slope(2, i, j, h.z);
        steepness.at(i, j, k) = std::sqrt(x * x + y * y + z * z);
      }
  });
  double kappa = p.edge_kappa_hu_per_mm;
  if (kappa == 0) {
    const Extent e = extent_of(steepness, counts, progress);
    kappa = p.edge_kappa * e.most;
    if (!(kappa > 0))
      throw refusal("volume", "it has no edges: every voxel of the region is alike",
                    {"move or widen `roi_min_mm` and `roi_max_mm`, or take another series"});
  }
  if (!std::isfinite(kappa))
    throw Error(ExitCode::bad_input, "", "volume", "its HU differ by more than float32 holds: they are no scan's");
  result.edge_kappa_hu_per_mm = kappa;
  const double exponent = p.edge_exponent;
  for_slices(g, progress, [&](std::size_t from, std::size_t to, int) {
    for (std::size_t v = from; v < to; ++v)
      g.voxels[v] = float(1 / (1 + std::pow(steepness.voxels[v] / kappa, exponent)));
  });
}

void classes(grid::Grid<float>& g, const grid::Mask& counts, const PresegmentParams& p, PresegmentResult& result,
             const Progress& progress) {
  const Extent e = extent_of(g, counts, progress);
  // One HU a bin; beyond what tissue and metal have, coarser.
  Histogram h;
  h.width = std::max(1.0, (double(e.most) - e.least) / 20000);
  h.first = e.least;
  const auto bin = [&](float x) { return std::size_t(std::max(0.0, (x - h.first) / h.width + 0.5)); };
  h.counts.resize(bin(e.most) + 1);
  for (std::size_t v = 0; v < g.count(); ++v)
    if (counts.voxels[v]) ++h.counts[bin(g.voxels[v])];
  const TissueMixture mixture = fit_mixture(h, p.classes_count);
  for (std::size_t c = 0; c < mixture.classes.size(); ++c)
    result.classes.emplace_back(
        "class_" + std::to_string(c + 1),
        ClassFigures{mixture.classes[c].mean, mixture.classes[c].sigma, mixture.classes[c].weight});
  std::vector<float> table;
  for (std::size_t b = 0; b < h.counts.size(); ++b)
    table.push_back(float(2 * mixture.share(h.first + double(b) * h.width, p.first_class - 1, p.last_class - 1) - 1));
  for_slices(g, progress, [&](std::size_t from, std::size_t to, int) {
    for (std::size_t v = from; v < to; ++v) {
      const double x = std::clamp((double(g.voxels[v]) - h.first) / h.width, 0.0, double(table.size() - 1));
      const std::size_t b = std::min(std::size_t(x), table.size() - 1), n = std::min(b + 1, table.size() - 1);
      g.voxels[v] = table[b] + float(x - double(b)) * (table[n] - table[b]);
    }
  });
}

void check_params(const PresegmentParams& p) {
  if (p.method == PresegmentMethod::regions && p.sides == PresegmentSides::both && !(p.lower_hu < p.upper_hu))
    throw Error(ExitCode::usage, "", "lower_hu, upper_hu",
                trephine::to_text(p.lower_hu) + " and " + trephine::to_text(p.upper_hu) +
                    ", the lower must be below the upper");
  if (p.method == PresegmentMethod::classes && (p.first_class > p.last_class || p.last_class > p.classes_count ||
                                                p.last_class - p.first_class + 1 == p.classes_count))
    throw Error(ExitCode::usage, "", "first_class, last_class",
                fmt::format("{} to {} of {} classes, must be some of them and not all", p.first_class, p.last_class,
                            p.classes_count));
}

}  // namespace

Outcome<grid::Field, PresegmentResult> presegment(const grid::HuVolume& volume, const PresegmentMasks& masks,
                                                  const PresegmentParams& p, const Progress& progress) {
  check_params(p);
  const mask::HuView hu(volume);
  grid::Box box = mask::region_of_interest(hu.lattice(), p.roi_min_mm, p.roi_max_mm);
  if (masks.within) {
    const grid::Box in =
        with_field("within", [&] { return mask::positive(*masks.within, grid::cropped(hu.lattice(), box)); }).bounds();
    if (in.empty())
      throw refusal("within", "0 voxels of the region lie inside",
                    {"give a `within` that meets the region, or move `roi_min_mm` and `roi_max_mm`"});
    grid::Box closer = box;
    for (int a = 0; a < 3; ++a) {
      closer.begin[a] = box.begin[a] + in.begin[a];
      closer.end[a] = box.begin[a] + in.end[a];
    }
    closer = grid::grown(closer, 4, hu.lattice());
    for (int a = 0; a < 3; ++a) {
      box.begin[a] = std::max(box.begin[a], closer.begin[a]);
      box.end[a] = std::min(box.end[a], closer.end[a]);
    }
  }
  grid::Grid<float> g = mask::crop(hu, box);
  for (std::size_t v = 0; v < g.count(); ++v)
    if (!std::isfinite(g.voxels[v]))
      throw Error(ExitCode::bad_input, "", "volume", fmt::format("a voxel is {}, must be finite", g.voxels[v]));

  grid::Mask counts(g, 1);
  const auto mask_out = [&](const grid::Field* mask, const char* name, bool keep) {
    if (!mask) return;
    const mask::BitMask bits = with_field(name, [&] { return mask::positive(*mask, g); });
    for (int k = 0; k < g.size[2]; ++k)
      for (int j = 0; j < g.size[1]; ++j)
        for (int i = 0; i < g.size[0]; ++i)
          if (bits.get(i, j, k) != keep) counts.at(i, j, k) = 0;
  };
  mask_out(masks.within, "within", true);
  mask_out(masks.without, "without", false);
  if (extent_of(g, counts, progress).count == 0)
    throw refusal("within, without", "0 voxels of the region are left",
                  {"give a larger `within` or a smaller `without`"});
  progress.report(0.2);

  PresegmentResult result;
  if (p.method != PresegmentMethod::edges) mask::gaussian(g, p.smoothing_sigma_mm, progress);
  switch (p.method) {
    case PresegmentMethod::regions:
      regions(g, counts, p, progress);
      break;
    case PresegmentMethod::edges:
      edges(g, counts, p, result, progress);
      break;
    case PresegmentMethod::classes:
      classes(g, counts, p, result, progress);
      break;
  }
  progress.report(0.9);

  const Extent e = extent_of(g, counts, progress);
  result.speed_positive_ratio = double(e.positive) / double(e.count);
  if (e.positive == 0)
    throw refusal("speed",
                  fmt::format("nowhere above 0 (the largest is {:.3f}): the structure is not in the region, or the "
                              "presegmentation misses it",
                              e.most),
                  {"move `lower_hu` and `upper_hu` (or `first_class` and `last_class`) to the structure, or widen "
                   "`roi_min_mm` and `roi_max_mm`"});
  if (e.positive == e.count && e.count == g.count() && p.method != PresegmentMethod::edges)
    throw refusal("speed", fmt::format("nowhere below 0 (the least is {:.3f}): nothing would hold a surface", e.least),
                  {"narrow `lower_hu` to `upper_hu` (or `first_class` to `last_class`), or give `within`"});
  for_slices(g, progress, [&](std::size_t from, std::size_t to, int) {
    for (std::size_t v = from; v < to; ++v) g.voxels[v] = counts.voxels[v] ? std::clamp(g.voxels[v], -1.f, 1.f) : -1.f;
  });
  return {std::move(g), std::move(result), {}};
}

}  // namespace trephine::segmentation
