// SPDX-License-Identifier: GPL-3.0-or-later
#include "itk/denoise.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <type_traits>

#include "base/error.h"
#include "base/refusal.h"
#include "base/text.h"
#include "itk/denoise_message.h"
#include "itk/itk_child.h"
#include "itk/non_local_means.h"

namespace trephine::itk {
namespace {

constexpr double max_effort = 5000;

// The box of the volume's voxels about where the field is positive.
grid::Box box_of(const grid::Lattice& volume, const grid::Field* within, double margin_mm) {
  if (!within) return grid::whole_box(volume);
  const grid::Box place = grid::place_in(*within, volume);
  grid::Box box{volume.size, {0, 0, 0}};
  for (int k = 0; k < within->size[2]; ++k)
    for (int j = 0; j < within->size[1]; ++j)
      for (int i = 0; i < within->size[0]; ++i) {
        if (!(within->at(i, j, k) > 0)) continue;
        const std::array<int, 3> v{i + place.begin[0], j + place.begin[1], k + place.begin[2]};
        for (std::size_t a = 0; a < 3; ++a) {
          box.begin[a] = std::min(box.begin[a], v[a]);
          box.end[a] = std::max(box.end[a], v[a] + 1);
        }
      }
  if (box.empty()) throw Error(ExitCode::bad_input, "", "within", "is nowhere positive");
  for (std::size_t a = 0; a < 3; ++a) {
    const int margin = static_cast<int>(std::ceil(margin_mm / volume.spacing_mm[static_cast<int>(a)]));
    box.begin[a] = std::max(0, box.begin[a] - margin);
    box.end[a] = std::min(volume.size[a], box.end[a] + margin);
  }
  return box;
}

template <class T>
grid::Grid<float> floats_in(const grid::Grid<T>& grid, const grid::Box& box) {
  grid::Grid<float> out(grid::cropped(grid, box));
  for (int k = 0; k < out.size[2]; ++k)
    for (int j = 0; j < out.size[1]; ++j)
      for (int i = 0; i < out.size[0]; ++i) {
        const float v = static_cast<float>(grid.at(i + box.begin[0], j + box.begin[1], k + box.begin[2]));
        if (!std::isfinite(v)) throw Error(ExitCode::bad_input, "", "volume", "holds a voxel that is not finite");
        out.at(i, j, k) = v;
      }
  return out;
}

NonLocalMeans means_of(const DenoiseParams& p) { return {p.search_mm, p.patch_mm, p.edge_hu / 2}; }

// How many values each voxel is made of (median, bilateral), or how often the volume is gone through (curvature).
double effort_of(const DenoiseParams& p, const grid::Lattice& l, int iterations) {
  if (p.method == DenoiseMethod::gaussian) return 1;
  if (p.method == DenoiseMethod::non_local_means) return static_cast<double>(patches_compared(l, means_of(p)));
  if (p.method == DenoiseMethod::curvature) return iterations;
  double count = 1;
  for (int a = 0; a < 3; ++a)
    count *= 1 + 2 * std::ceil((p.method == DenoiseMethod::median ? 1 : 2.5) * p.sigma_mm / l.spacing_mm[a]);
  return count;
}

ChildResult filtered_by_itk(const grid::Grid<float>& before, const DenoiseTask& task, double effort,
                            const Progress& progress) {
  MessageWriter request = itk_child::request();
  request.value(task);
  itk_child::put(request, before);
  ChildLimits limits;
  const std::uint64_t bytes = before.voxels.size() * sizeof(float);
  limits.memory_bytes = (std::uint64_t{4} << 30) + 10 * bytes;
  limits.cpu_s = 120 + 2e-6 * effort * static_cast<double>(before.voxels.size());
  limits.wall_s = 2 * limits.cpu_s;
  ChildResult result = itk_child::run(denoise_worker_name, request, limits, progress);
  if (result.bytes().size() != bytes)
    throw Error(ExitCode::internal, "", denoise_worker_name, "the child gave another number of bytes");
  return result;
}

}  // namespace

Outcome<grid::HuVolume, DenoiseResult> denoise(const grid::HuVolume& volume, const grid::Field* within,
                                               const DenoiseParams& params, const Progress& progress) {
  const grid::Lattice& lattice = grid::lattice_of(volume);
  const double margin_mm =
      params.method == DenoiseMethod::non_local_means ? params.search_mm + params.patch_mm : 4 * params.sigma_mm;
  const grid::Box box = box_of(lattice, within, margin_mm);
  const grid::Grid<float> before = std::visit([&](const auto& grid) { return floats_in(grid, box); }, volume);
  if (params.method == DenoiseMethod::gaussian && *std::min_element(before.size.begin(), before.size.end()) < 4)
    throw Error(ExitCode::bad_input, "", "volume",
                "has fewer than 4 voxels along an axis, which method gaussian needs");
  DenoiseTask task;
  task.method = static_cast<std::int32_t>(params.method);
  task.sigma_mm = params.sigma_mm;
  task.edge_hu = params.edge_hu;
  // ITK's bound for a stable step in three dimensions; diffusion for a time t is a Gaussian of sqrt(2 t).
  const double most = std::min({lattice.spacing_mm.x, lattice.spacing_mm.y, lattice.spacing_mm.z}) / 16;
  const double time = params.sigma_mm * params.sigma_mm / 2;
  task.iterations = std::max(1, static_cast<int>(std::ceil(time / most)));
  task.step = time / task.iterations;
  const double effort = effort_of(params, lattice, task.iterations);
  if (effort > max_effort)
    throw Error(ExitCode::usage, "", params.method == DenoiseMethod::non_local_means ? "search_mm" : "sigma_mm",
                "needs " + to_text(effort) + " steps a voxel of this size, at most " + to_text(max_effort) +
                    ": take less, or method gaussian");
  const bool own = params.method == DenoiseMethod::non_local_means;
  const ChildResult result = own ? ChildResult() : filtered_by_itk(before, task, effort, progress.part(0.1, 0.9));
  const grid::Grid<float> means =
      own ? non_local_means(before, means_of(params), progress.part(0.1, 0.9)) : grid::Grid<float>();
  grid::HuVolume out = volume;
  double sum = 0, square = 0;
  std::size_t soft = 0;
  std::visit(
      [&](auto& grid) {
        using T = typename std::decay_t<decltype(grid)>::Sample;
        const char* from = own ? reinterpret_cast<const char*>(means.voxels.data()) : result.bytes().data();
        for (int k = box.begin[2]; k < box.end[2]; ++k)
          for (int j = box.begin[1]; j < box.end[1]; ++j)
            for (int i = box.begin[0]; i < box.end[0]; ++i, from += sizeof(float)) {
              float v;
              std::memcpy(&v, from, sizeof v);
              if (!std::isfinite(v))
                throw refusal("method", "diverged: a voxel is not finite", {"choose another `method`"});
              T& to = grid.at(i, j, k);
              const double taken = double(to) - double(v);
              if (v > -100 && v < 100) sum += taken, square += taken * taken, ++soft;
              if constexpr (std::is_integral_v<T>)
                to = static_cast<T>(std::lround(std::clamp(double(v), -32768.0, 32767.0)));
              else
                to = v;
            }
      },
      out);
  DenoiseResult figures;
  figures.voxels_count = before.voxels.size();
  if (params.method == DenoiseMethod::curvature) figures.iterations_count = task.iterations;
  const double mean = soft ? sum / double(soft) : 0;
  figures.removed_hu = soft ? std::sqrt(std::max(0.0, square / double(soft) - mean * mean)) : 0.0;
  return {std::move(out), figures, {}};
}

}  // namespace trephine::itk
