// SPDX-License-Identifier: GPL-3.0-or-later
#include "head/ventricles_smooth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/parallel.h"
#include "mask/filters.h"

namespace trephine::head {
namespace {

// The surface is smoothed by Gaussians, the thicker the shape is there, the wider.
constexpr std::array<double, 3> smooth_mm{1.3, 1.95, 2.9};
constexpr double smooth_per_thickness = 0.9, thickness_reach_mm = 4, thickness_sigma_mm = 2;
// In a neck or a thin wall: what smoothing would move by the first of these at most is noise, by the second is not.
constexpr float noise_moves_mm = 0.3f, neck_moves_mm = 0.8f;

/// Each voxel gets the largest value within a box about it.
void spread_largest(grid::Grid<float>& g, double reach_mm, const Progress& progress) {
  for (int axis = 0; axis < 3; ++axis) {
    const int reach = std::max(1, int(std::lround(reach_mm / g.spacing_mm[axis])));
    const grid::Grid<float> in = g;
    parallel_for(0, g.size[2], 2, [&](std::int64_t begin, std::int64_t end) {
      progress.check();
      for (int k = int(begin); k < end; ++k)
        for (int j = 0; j < g.size[1]; ++j) {
          float* row = &g.at(0, j, k);
          for (int r = -reach; r <= reach; ++r) {
            if (axis == 0) {
              for (int i = std::max(0, -r); i < std::min(g.size[0], g.size[0] - r); ++i)
                row[i] = std::max(row[i], in.at(i + r, j, k));
            } else {
              const int y = axis == 1 ? j + r : j, z = axis == 2 ? k + r : k;
              if (y < 0 || z < 0 || y >= g.size[1] || z >= g.size[2]) continue;
              for (int i = 0; i < g.size[0]; ++i) row[i] = std::max(row[i], in.at(i, y, z));
            }
          }
        }
    });
  }
}

}  // namespace

void smooth_fit(grid::Grid<float>& distance, const mask::BitMask* necks, const Progress& progress) {
  for (float& d : distance.voxels) d = std::clamp(d, float(-fit_far_mm), float(fit_far_mm));
  grid::Grid<float> thickness = distance;
  spread_largest(thickness, thickness_reach_mm, progress);
  mask::gaussian(thickness, thickness_sigma_mm, progress);
  const auto smoothed = [&](double sigma_mm) {
    grid::Grid<float> once = distance;
    mask::gaussian(once, sigma_mm, progress);
    grid::Grid<float> twice = once;
    mask::gaussian(twice, sigma_mm, progress);
    for (std::size_t v = 0; v < once.voxels.size(); ++v) once.voxels[v] = 2 * once.voxels[v] - twice.voxels[v];
    return once;
  };
  grid::Grid<float> before = smoothed(smooth_mm[0]), out = before;
  for (std::size_t n = 1; n < smooth_mm.size(); ++n) {
    grid::Grid<float> next = smoothed(smooth_mm[n]);
    const float from = float(smooth_mm[n - 1]), width = float(smooth_mm[n]) - from;
    for (std::size_t v = 0; v < out.voxels.size(); ++v) {
      const float t = (float(smooth_per_thickness) * thickness.voxels[v] - from) / width;
      if (t > 0) out.voxels[v] = before.voxels[v] + std::min(t, 1.f) * (next.voxels[v] - before.voxels[v]);
    }
    before = std::move(next);
  }
  if (necks) {
    const int parts = out.size[2] / necks->lattice().size[2];
    for (int k = 0; k < out.size[2]; ++k)
      for (int j = 0; j < out.size[1]; ++j)
        for (int i = 0; i < out.size[0]; ++i) {
          if (!necks->get(i, j, k / parts)) continue;
          float& to = out.at(i, j, k);
          const float from = distance.at(i, j, k), moves = to - from;
          to =
              from + moves * std::clamp((neck_moves_mm - std::abs(moves)) / (neck_moves_mm - noise_moves_mm), 0.f, 1.f);
        }
  }
  distance = std::move(out);
}

}  // namespace trephine::head
