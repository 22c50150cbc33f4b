// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"
#include "mask/coarse.h"
#include "mask/filters.h"
#include "trunk/canal_parts.h"

namespace trephine::trunk {
namespace {

constexpr double coarse_mm = 1.5;
constexpr double min_clearance_mm = 2.5;  ///< from bone, at the canal's middle
constexpr double steepest = 1.5;          ///< how many mm the course may go sidewards for each mm along the canal
constexpr double sideward_cost = 0.05;    ///< in enclosure times mm, for each mm that it goes sidewards
constexpr int rays = 24;

struct Ray {
  double x, y;
};

std::array<Ray, rays> directions() {
  std::array<Ray, rays> d;
  for (int r = 0; r < rays; ++r) d[r] = {std::cos(2 * M_PI * r / rays), std::sin(2 * M_PI * r / rays)};
  return d;
}

/// The share of directions in the slice in which bone stands within reach_mm. Steps as far as bone is away.
double enclosure(const mask::BitMask& bone, const grid::Grid<float>& to_bone, int i, int j, int k, double reach_mm,
                 const std::array<Ray, rays>& direction) {
  const Vec3 sp = to_bone.spacing_mm;
  const double min_step = 0.7 * std::min(sp.x, sp.y);
  int met = 0;
  for (const Ray& d : direction) {
    double t = to_bone.at(i, j, k);
    while (t <= reach_mm) {
      const int x = int(std::lround(i + d.x * t / sp.x)), y = int(std::lround(j + d.y * t / sp.y));
      if (x < 0 || y < 0 || x >= to_bone.size[0] || y >= to_bone.size[1]) break;
      if (bone.get(x, y, k)) {
        ++met;
        break;
      }
      t += std::max(min_step, double(to_bone.at(x, y, k)) - min_step);
    }
  }
  return double(met) / rays;
}

constexpr float forbidden = -1;

/// The enclosure of each cell's middle; `forbidden` within bone, close to it, and far from any bone.
grid::Grid<float> enclosures(const mask::BitMask& bone, const CanalParams& p, const Progress& progress) {
  const grid::Grid<float> to_bone = mask::distance_mm(bone, progress);
  grid::Grid<float> out(bone.lattice(), forbidden);
  const auto direction = directions();
  parallel_for(0, out.size[2], 1, [&](std::int64_t from, std::int64_t to) {
    progress.check();
    for (int k = int(from); k < to; ++k)
      for (int j = 0; j < out.size[1]; ++j)
        for (int i = 0; i < out.size[0]; ++i) {
          const float d = to_bone.at(i, j, k);
          if (d < min_clearance_mm || d > p.max_radius_mm) continue;
          out.at(i, j, k) = float(enclosure(bone, to_bone, i, j, k, p.max_radius_mm, direction));
        }
  });
  return out;
}

struct Step {
  std::int16_t di = 0, dj = 0;
  bool first = true;
};

/// The chain of cells with the largest sum of (enclosure - least) times mm.
std::vector<std::array<int, 3>> best_chain(const grid::Grid<float>& enclosed, double least, const Progress& progress) {
  const int nx = enclosed.size[0], ny = enclosed.size[1], nz = enclosed.size[2];
  const Vec3 sp = enclosed.spacing_mm;
  const int wi = int(steepest * sp.z / sp.x + 0.999), wj = int(steepest * sp.z / sp.y + 0.999);
  std::vector<double> cost((2 * wi + 1) * (2 * wj + 1));
  for (int dj = -wj; dj <= wj; ++dj)
    for (int di = -wi; di <= wi; ++di)
      cost[(dj + wj) * (2 * wi + 1) + di + wi] = sideward_cost * std::hypot(di * sp.x, dj * sp.y);
  const std::size_t slice = std::size_t(nx) * ny;
  std::vector<float> sum(slice, 0), before(slice, 0);
  std::vector<Step> steps(enclosed.count());
  double best = 0;
  std::array<int, 3> end{-1, -1, -1};
  for (int k = 0; k < nz; ++k) {
    progress.check();
    std::swap(sum, before);
    parallel_for(0, ny, 8, [&](std::int64_t from, std::int64_t to) {
      for (int j = int(from); j < to; ++j)
        for (int i = 0; i < nx; ++i) {
          const float e = enclosed.at(i, j, k);
          float& s = sum[std::size_t(j) * nx + i];
          s = -1e9f;
          if (e == forbidden) continue;
          double most = 0;
          Step step;
          if (k > 0)
            for (int y = std::max(0, j - wj); y <= std::min(ny - 1, j + wj); ++y)
              for (int x = std::max(0, i - wi); x <= std::min(nx - 1, i + wi); ++x) {
                const double v = before[std::size_t(y) * nx + x] - cost[(y - j + wj) * (2 * wi + 1) + x - i + wi];
                if (v > most) most = v, step = {std::int16_t(x - i), std::int16_t(y - j), false};
              }
          s = float(most + (e - least) * sp.z);
          steps[enclosed.index(i, j, k)] = step;
        }
    });
    for (std::size_t v = 0; v < slice; ++v)
      if (sum[v] > best) best = sum[v], end = {int(v % nx), int(v / nx), k};
  }
  std::vector<std::array<int, 3>> chain;
  if (end[0] < 0) return chain;
  for (auto at = end;;) {
    chain.push_back(at);
    const Step s = steps[enclosed.index(at[0], at[1], at[2])];
    if (s.first) break;
    at = {at[0] + s.di, at[1] + s.dj, at[2] - 1};
  }
  std::reverse(chain.begin(), chain.end());
  return chain;
}

}  // namespace

CanalCourse canal_course(const mask::BitMask& bone, const CanalParams& params, const Progress& progress) {
  const mask::CoarseRaster c = mask::coarse_raster(bone.lattice(), coarse_mm);
  const grid::Grid<float> enclosed = enclosures(mask::coarse_mask(bone, c, 0), params, progress);
  const auto chain = best_chain(enclosed, params.min_enclosure_ratio, progress);
  CanalCourse course;
  if (chain.empty()) return course;
  const int slices = bone.lattice().size[2];
  course.first_slice = chain.front()[2] * c.factor[2];
  const int end = std::min(slices, (chain.back()[2] + 1) * c.factor[2]);
  for (int k = course.first_slice; k < end; ++k) {
    // Between the cells' middles, linearly.
    const double z =
        std::clamp((k - (c.factor[2] - 1) / 2.0) / c.factor[2] - chain.front()[2], 0.0, double(chain.size() - 1));
    const std::size_t low = std::min(std::size_t(z), chain.size() - 1), high = std::min(low + 1, chain.size() - 1);
    const auto at = [&](int axis) {
      const double cell = chain[low][axis] + (z - double(low)) * (chain[high][axis] - chain[low][axis]);
      return cell * c.factor[axis] + (c.factor[axis] - 1) / 2.0;
    };
    course.points.push_back({at(0), at(1)});
  }
  return course;
}

}  // namespace trephine::trunk
