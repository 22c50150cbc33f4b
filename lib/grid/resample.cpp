// SPDX-License-Identifier: GPL-3.0-or-later
#include "grid/resample.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "base/error.h"
#include "base/memory_budget.h"
#include "base/parallel.h"
#include "base/refusal.h"

namespace trephine::grid {
namespace {

// What one new sample along an axis is made of: old samples first, first + 1, ... with their weights, which sum to 1.
struct Tap {
  int first = 0;
  std::vector<double> weights;
};

std::vector<Tap> taps_of(int old_size, double old_step, int new_size, double new_step) {
  // The average over a box as wide as the larger voxel. Old voxels are taken as constant, so a box as wide as they are
  // interpolates linearly.
  const double width = std::max(1.0, new_step / old_step);
  std::vector<Tap> taps(static_cast<std::size_t>(new_size));
  for (int i = 0; i < new_size; ++i) {
    const double middle = (i - (new_size - 1) / 2.0) * (new_step / old_step) + (old_size - 1) / 2.0;
    const double from = middle - width / 2, to = middle + width / 2;
    const int first = static_cast<int>(std::floor(from + 0.5)), last = static_cast<int>(std::ceil(to - 0.5));
    Tap& tap = taps[static_cast<std::size_t>(i)];
    tap.first = std::clamp(first, 0, old_size - 1);
    tap.weights.assign(static_cast<std::size_t>(std::clamp(last, 0, old_size - 1) - tap.first + 1), 0.0);
    for (int j = first; j <= last; ++j) {
      const double share = std::min(to, j + 0.5) - std::max(from, j - 0.5);
      if (share > 0) tap.weights[static_cast<std::size_t>(std::clamp(j, 0, old_size - 1) - tap.first)] += share / width;
    }
    // Voxels that are cut through weigh about their centres, not about the cut: without this a ramp would shift to and
    // fro by hundredths of a voxel.
    if (first < 0 || last >= old_size || last == first) continue;
    double centre = 0;
    for (int j = first; j <= last; ++j) centre += j * tap.weights[static_cast<std::size_t>(j - first)];
    const double off = (middle - centre) / (last - first);
    tap.weights.front() -= off;
    tap.weights.back() += off;
  }
  return taps;
}

// Resamples one axis at a time, slowest first, so that the volume in between is never larger than the larger of input
// and result.
template <class In, class Out>
Grid<Out> along(const Grid<In>& in, int axis, const std::vector<Tap>& taps, double step_mm, const Progress& progress) {
  Lattice lattice = in;
  lattice.size[axis] = static_cast<int>(taps.size());
  Vec3 first{0, 0, 0};
  first[axis] = (in.size[axis] - 1) / 2.0 - (lattice.size[axis] - 1) / 2.0 * step_mm / in.spacing_mm[axis];
  lattice.origin_mm = in.to_world_mm(first);
  lattice.spacing_mm[axis] = step_mm;
  Grid<Out> out(lattice);
  std::size_t stride = 1;
  for (int a = 0; a < axis; ++a) stride *= static_cast<std::size_t>(in.size[a]);
  // Rows of x for the slower axes, single samples of it for x itself.
  const int rows = axis == 2 ? lattice.size[2] : lattice.size[1] * lattice.size[2];
  const std::size_t row = axis == 2 ? std::size_t(in.size[0]) * in.size[1] : std::size_t(lattice.size[0]);
  parallel_for(0, rows, axis == 2 ? 1 : 64, [&](std::int64_t begin, std::int64_t end) {
    std::vector<double> sum(row);
    for (std::int64_t r = begin; r < end; ++r) {
      progress.check();
      std::fill(sum.begin(), sum.end(), 0.0);
      const auto add = [&](const Tap& tap, const In* from) {
        for (std::size_t w = 0; w < tap.weights.size(); ++w, from += stride)
          for (std::size_t x = 0; x < row; ++x) sum[x] += tap.weights[w] * double(from[x]);
      };
      if (axis == 2) {
        const Tap& tap = taps[static_cast<std::size_t>(r)];
        add(tap, in.voxels.data() + stride * static_cast<std::size_t>(tap.first));
      } else if (axis == 1) {
        const int k = static_cast<int>(r / lattice.size[1]);
        const Tap& tap = taps[static_cast<std::size_t>(r % lattice.size[1])];
        add(tap, in.voxels.data() + in.index(0, tap.first, k));
      } else {
        const In* from = in.voxels.data() + static_cast<std::size_t>(r) * in.size[0];
        for (std::size_t x = 0; x < row; ++x)
          for (std::size_t w = 0; w < taps[x].weights.size(); ++w)
            sum[x] += taps[x].weights[w] * double(from[static_cast<std::size_t>(taps[x].first) + w]);
      }
      Out* to = out.voxels.data() + static_cast<std::size_t>(r) * row;
      for (std::size_t x = 0; x < row; ++x)
        to[x] = static_cast<Out>(std::is_integral_v<Out> ? std::round(sum[x]) : sum[x]);
    }
  });
  return out;
}

template <class T>
Grid<T> resampled(const Grid<T>& in, const std::array<double, 3>& step_mm, const Progress& progress) {
  Grid<float> between;
  bool is_first = true;
  int last_axis = -1;
  for (int axis = 0; axis < 3; ++axis)
    if (step_mm[axis] != in.spacing_mm[axis]) last_axis = last_axis < 0 ? axis : last_axis;
  if (last_axis < 0) return in;
  // In float32 between the axes, rounded once at the end.
  for (int axis = 2; axis >= 0; --axis) {
    if (step_mm[axis] == in.spacing_mm[axis]) continue;
    const int count = std::max(1, static_cast<int>(std::lround(in.size[axis] * in.spacing_mm[axis] / step_mm[axis])));
    const auto taps = taps_of(in.size[axis], in.spacing_mm[axis], count, step_mm[axis]);
    if (axis == last_axis)
      return is_first ? along<T, T>(in, axis, taps, step_mm[axis], progress)
                      : along<float, T>(between, axis, taps, step_mm[axis], progress);
    between = is_first ? along<T, float>(in, axis, taps, step_mm[axis], progress)
                       : along<float, float>(between, axis, taps, step_mm[axis], progress);
    is_first = false;
    progress.report((3 - axis) / 3.0);
  }
  return in;  // unreachable: the loop meets last_axis
}

}  // namespace

HuVolume resample(const HuVolume& volume, const ResampleParams& params, Report& report, const Progress& progress) {
  const Lattice& old = lattice_of(volume);
  std::array<double, 3> step_mm{};
  double voxels = 1;
  for (int a = 0; a < 3; ++a) {
    if (!(params.spacing_mm[a] >= 0) || !std::isfinite(params.spacing_mm[a]))
      throw Error(ExitCode::usage, "", "spacing_mm",
                  to_text(ParameterValue(params.spacing_mm[a])) + ", must be 0 or more");
    step_mm[a] = params.spacing_mm[a] > 0 ? params.spacing_mm[a] : old.spacing_mm[a];
    voxels *= std::max(1.0, old.size[a] * old.spacing_mm[a] / step_mm[a]);
  }
  if (const auto* g = std::get_if<Grid<float>>(&volume))
    for (const float v : g->voxels)
      if (!std::isfinite(v)) throw Error(ExitCode::bad_input, "", "volume", "a voxel is NaN or infinite");
  constexpr double max_voxels = 4e9;
  if (voxels > max_voxels)
    throw refusal("spacing_mm", "would make more than 4e9 voxels of this volume", {"choose a larger `spacing_mm`"});
  const std::size_t voxel_bytes = std::visit([](const auto& g) { return sizeof(g.voxels[0]); }, volume);
  require_memory(static_cast<std::uint64_t>(voxels) * voxel_bytes, "a volume of this `spacing_mm`");
  HuVolume out = std::visit([&](const auto& g) { return HuVolume(resampled(g, step_mm, progress)); }, volume);
  const Lattice& made = lattice_of(out);
  report.figures.emplace_back("spacing_mm", std::vector<double>{step_mm[0], step_mm[1], step_mm[2]});
  double coarser = 0;
  for (int a = 0; a < 3; ++a) coarser = std::max(coarser, step_mm[a] / old.spacing_mm[a]);
  report.add("coarsest_ratio", coarser);
  report.add("voxels_count", made.count());
  report.add("voxels_ratio", old.count() ? double(made.count()) / double(old.count()) : 1.0);
  progress.report(1);
  return out;
}

}  // namespace trephine::grid
