// SPDX-License-Identifier: GPL-3.0-or-later
// Lattices, and what is sampled from the CT itself.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/error.h"
#include "base/parallel.h"
#include "base/text.h"
#include "voxel/cut_solid.h"
#include "voxel/voxelize.h"

namespace trephine::voxel {
namespace {

// Trilinear; within half a voxel beyond the last centres the nearest samples, farther away haptic_beyond_hu.
template <class T>
class Sampler {
 public:
  explicit Sampler(const grid::Grid<T>& grid) : grid_(grid) {}

  double at(Vec3 index) const {
    int begin[3], step[3];
    double f[3];
    for (int a = 0; a < 3; ++a) {
      const int size = grid_.size[std::size_t(a)];
      if (!(index[a] >= -0.5 - slack && index[a] <= size - 0.5 + slack)) return haptic_beyond_hu;
      double x = std::clamp(index[a], 0.0, double(size - 1));
      if (std::abs(x - std::round(x)) < slack) x = std::round(x);  // the same raster gives the same samples
      begin[a] = std::min(int(x), std::max(0, size - 2));
      step[a] = size > 1 ? 1 : 0;
      f[a] = x - begin[a];
    }
    double sum = 0;
    for (int c = 0; c < 8; ++c) {
      const double w = (c & 1 ? f[0] : 1 - f[0]) * (c & 2 ? f[1] : 1 - f[1]) * (c & 4 ? f[2] : 1 - f[2]);
      if (w > 0)
        sum += w *
               grid_.at(begin[0] + (c & 1) * step[0], begin[1] + (c >> 1 & 1) * step[1], begin[2] + (c >> 2) * step[2]);
    }
    return sum;
  }

 private:
  static constexpr double slack = 1e-6;
  const grid::Grid<T>& grid_;
};

// Calls each(voxel, HU, k) for every voxel of the lattice, slices in parallel.
template <class Each>
void sample(const grid::HuVolume& volume, const grid::Lattice& lattice, const Progress& progress, const Each& each) {
  std::visit(
      [&](const auto& grid) {
        using T = typename std::decay_t<decltype(grid)>::Sample;
        const Sampler<T> sampler(grid);
        parallel_for(0, lattice.size[2], 1, [&](std::int64_t from, std::int64_t) {
          const int k = int(from);
          progress.check();
          for (int j = 0; j < lattice.size[1]; ++j)
            for (int i = 0; i < lattice.size[0]; ++i) {
              const Vec3 world = lattice.to_world_mm({double(i), double(j), double(k)});
              each(lattice.index(i, j, k), sampler.at(grid.to_index(world)), k);
            }
        });
      },
      volume);
  progress.report(1);
}

[[noreturn]] void refuse_window(const std::string& name, const std::string& what) {
  throw Error(ExitCode::bad_config, "", "haptic.windows." + name, what);
}

}  // namespace

grid::Lattice haptic_lattice(const surface::Bounds& region_mm, const Mat3& direction, Vec3 anchor_mm,
                             const VoxelizeParams& params) {
  constexpr double slack = 1e-6;  // of a voxel: what rounding may add to a region of whole voxels
  const auto refuse = [](const std::string& what) { throw Error(ExitCode::bad_config, "", "haptic.spacing_mm", what); };
  grid::Lattice lattice;
  lattice.direction = direction;
  for (int a = 0; a < 3; ++a) lattice.spacing_mm[a] = params.spacing_mm[std::size_t(a)];
  lattice.origin_mm = anchor_mm;
  const auto [low, high] = surface::index_bounds(lattice, region_mm);
  Vec3 first;
  double voxels = 1;
  double size[3];
  for (int a = 0; a < 3; ++a) {
    if (!(region_mm.min_mm[a] <= region_mm.max_mm[a]) || !std::isfinite(low[a]) || !std::isfinite(high[a]) ||
        !(std::max(std::abs(low[a]), std::abs(high[a])) < 1e9))
      throw Error(ExitCode::bad_config, "", "haptic.region", "is not a box of finite size");
    first[a] = std::floor(low[a] + 0.5 + slack);
    size[a] = std::max(1.0, std::ceil(high[a] - 0.5 - slack) - first[a] + 1);
    voxels *= size[a];
  }
  if (!(voxels <= params.max_voxels_millions * 1e6))
    refuse("the region needs " + grouped_text((long long)(std::min(voxels, 9e18))) + " voxels, more than " +
           to_text(params.max_voxels_millions) + " million: take larger voxels or a smaller region");
  for (int a = 0; a < 3; ++a) lattice.size[std::size_t(a)] = int(size[a]);
  lattice.origin_mm = lattice.to_world_mm(first);
  return lattice;
}

Outcome<HapticVolume, VoxelizeResult> voxelize_hu(const grid::HuVolume& volume, const grid::Lattice& lattice,
                                                  const std::vector<HuWindow>& windows, const Progress& progress) {
  if (windows.empty() || windows.size() > std::size_t(haptic_max_shapes))
    throw Error(ExitCode::bad_config, "", "haptic.windows",
                std::to_string(windows.size()) + ", must be 1 to " + std::to_string(haptic_max_shapes));
  HapticVolume out;
  out.encoding = HapticEncoding::hu;
  for (const HuWindow& w : windows) {
    if (w.low_hu > w.high_hu)
      refuse_window(w.name, std::to_string(w.low_hu) + " to " + std::to_string(w.high_hu) + " HU holds nothing");
    if (w.low_hu <= haptic_beyond_hu)
      refuse_window(w.name, "begins at " + std::to_string(w.low_hu) + " HU, must be above " +
                                std::to_string(haptic_beyond_hu) + ": that is what lies beyond the volume");
    for (const HapticShape& s : out.shapes)
      if (w.low_hu <= s.window_high && s.window_low <= w.high_hu) refuse_window(w.name, "overlaps that of " + s.name);
    out.shapes.push_back({w.name, int(out.shapes.size() + 1), w.low_hu, w.high_hu});
  }
  out.voxels = grid::Grid<std::int16_t>(lattice);
  std::vector<std::size_t> clamped(std::size_t(std::max(0, lattice.size[2])), 0);
  std::vector<std::array<std::size_t, haptic_max_shapes>> counts(clamped.size(), {{}});
  sample(volume, lattice, progress, [&](std::size_t at, double hu, int k) {
    using Limits = std::numeric_limits<std::int16_t>;
    const double whole = std::floor(hu + 0.5);
    const double held = std::clamp(whole, double(Limits::min()), double(Limits::max()));
    clamped[std::size_t(k)] += held != whole;
    const auto value = std::int16_t(held);
    out.voxels.voxels[at] = value;
    for (std::size_t n = 0; n < out.shapes.size(); ++n)
      counts[std::size_t(k)][n] += value >= out.shapes[n].window_low && value <= out.shapes[n].window_high;
  });
  check_haptic_volume(out);
  VoxelizeResult result;
  for (std::size_t n = 0; n < out.shapes.size(); ++n) {
    std::size_t count = 0;
    for (const auto& c : counts) count += c[n];
    result.shapes.emplace_back(out.shapes[n].name,
                               ShapeVoxels{double(count) * lattice.voxel_volume_mm3() / 1000, count, {}});
  }
  result.clamped_voxels_count = std::accumulate(clamped.begin(), clamped.end(), std::int64_t{0});
  return {std::move(out), std::move(result), {}};
}

grid::Mask haptic_hardness(const grid::HuVolume& volume, const grid::Lattice& lattice, double low_hu, double high_hu,
                           const Progress& progress) {
  if (!(low_hu < high_hu))
    throw Error(ExitCode::bad_config, "", "haptic.hardness",
                to_text(low_hu) + " to " + to_text(high_hu) + " HU: the first must be the lower");
  grid::Mask hardness(lattice);
  sample(volume, lattice, progress, [&](std::size_t at, double hu, int) {
    const double share = std::clamp((hu - low_hu) / (high_hu - low_hu), 0.0, 1.0);
    hardness.voxels[at] = std::uint8_t(std::floor(255 * share + 0.5));
  });
  return hardness;
}

}  // namespace trephine::voxel
