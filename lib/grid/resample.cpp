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

// The lattice with `count` voxels of that size along the axis, about the same middle.
Lattice along(const Lattice& in, int axis, int count, double step_mm) {
  Lattice out = in;
  out.size[axis] = count;
  Vec3 first{0, 0, 0};
  first[axis] = (in.size[axis] - 1) / 2.0 - (count - 1) / 2.0 * step_mm / in.spacing_mm[axis];
  out.origin_mm = in.to_world_mm(first);
  out.spacing_mm[axis] = step_mm;
  return out;
}

// Resamples `size` voxels from `in` along one axis into `out`, which has taps.size() of them there.
template <class In, class Out>
void resample_axis(const In* in, const std::array<int, 3>& size, int axis, const Tap* taps, int count, Out* out,
                   const Progress& progress) {
  std::array<int, 3> made = size;
  made[axis] = count;
  std::size_t stride = 1;
  for (int a = 0; a < axis; ++a) stride *= static_cast<std::size_t>(size[a]);
  // Rows of x for the slower axes, single samples of it for x itself.
  const int rows = axis == 2 ? made[2] : made[1] * made[2];
  const std::size_t row = axis == 2 ? std::size_t(size[0]) * size[1] : std::size_t(made[0]);
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
        add(taps[r], in + stride * static_cast<std::size_t>(taps[r].first));
      } else if (axis == 1) {
        const auto k = static_cast<std::size_t>(r / count);
        const Tap& tap = taps[r % count];
        add(tap, in + (k * static_cast<std::size_t>(size[1]) + static_cast<std::size_t>(tap.first)) * stride);
      } else {
        const In* from = in + static_cast<std::size_t>(r) * static_cast<std::size_t>(size[0]);
        for (std::size_t x = 0; x < row; ++x)
          for (std::size_t w = 0; w < taps[x].weights.size(); ++w)
            sum[x] += taps[x].weights[w] * double(from[static_cast<std::size_t>(taps[x].first) + w]);
      }
      Out* to = out + static_cast<std::size_t>(r) * row;
      for (std::size_t x = 0; x < row; ++x)
        to[x] = static_cast<Out>(std::is_integral_v<Out> ? std::round(sum[x]) : sum[x]);
    }
  });
}

}  // namespace

// Some slices of the result at a time, each of them along z, then y, then x: what lies between is in float32, rounded
// once at the end, and as large as those slices alone.
template <class T>
Grid<T> resampled_grid(const Grid<T>& in, const std::array<double, 3>& step_mm, const Progress& progress) {
  Lattice lattice = in;
  std::array<std::vector<Tap>, 3> taps;
  int last_axis = -1;
  for (int axis = 2; axis >= 0; --axis) {
    if (step_mm[axis] == in.spacing_mm[axis]) continue;
    const int count = std::max(1, static_cast<int>(std::lround(in.size[axis] * in.spacing_mm[axis] / step_mm[axis])));
    taps[axis] = taps_of(in.size[axis], in.spacing_mm[axis], count, step_mm[axis]);
    lattice = along(lattice, axis, count, step_mm[axis]);
    last_axis = axis;
  }
  if (last_axis < 0) return in;
  Grid<T> out(lattice);
  constexpr int slices_at_once = 32;
  const std::size_t old_slice = std::size_t(in.size[0]) * in.size[1], slice = std::size_t(out.size[0]) * out.size[1];
  std::vector<float> between, next;
  for (int begin = 0; begin < out.size[2]; begin += slices_at_once) {
    const int slices = std::min(slices_at_once, out.size[2] - begin);
    T* const to = out.voxels.data() + slice * static_cast<std::size_t>(begin);
    // Along z the taps choose the old slices; where z stays, the old slices are these.
    const T* from = in.voxels.data() + (taps[2].empty() ? old_slice * static_cast<std::size_t>(begin) : 0);
    std::array<int, 3> size{in.size[0], in.size[1], taps[2].empty() ? slices : in.size[2]};
    bool is_first = true;
    for (int axis = 2; axis >= last_axis; --axis) {
      if (taps[axis].empty()) continue;
      const Tap* first = taps[axis].data() + (axis == 2 ? begin : 0);
      const int count = axis == 2 ? slices : out.size[axis];
      const auto resample_to = [&](auto* target) {
        if (is_first)
          resample_axis(from, size, axis, first, count, target, progress);
        else
          resample_axis(between.data(), size, axis, first, count, target, progress);
      };
      if (axis == last_axis) {
        resample_to(to);
        break;
      }
      std::array<int, 3> made = size;
      made[axis] = count;
      next.resize(std::size_t(made[0]) * made[1] * made[2]);
      resample_to(next.data());
      std::swap(between, next);
      size = made;
      is_first = false;
    }
    progress.report(double(begin + slices) / out.size[2]);
  }
  return out;
}
template Grid<std::int16_t> resampled_grid(const Grid<std::int16_t>&, const std::array<double, 3>&, const Progress&);
template Grid<float> resampled_grid(const Grid<float>&, const std::array<double, 3>&, const Progress&);

Outcome<HuVolume, ResampleResult> resample(const HuVolume& volume, const ResampleParams& params,
                                           const Progress& progress) {
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
  HuVolume out = std::visit([&](const auto& g) { return HuVolume(resampled_grid(g, step_mm, progress)); }, volume);
  const Lattice& made = lattice_of(out);
  ResampleResult result{step_mm, 0, made.count(), 1};
  for (int a = 0; a < 3; ++a) result.coarsest_ratio = std::max(result.coarsest_ratio, step_mm[a] / old.spacing_mm[a]);
  if (old.count()) result.voxels_ratio = double(made.count()) / double(old.count());
  progress.report(1);
  return {std::move(out), result, {}};
}

}  // namespace trephine::grid
