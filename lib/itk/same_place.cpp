// SPDX-License-Identifier: GPL-3.0-or-later
#include "itk/same_place.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "base/parallel.h"

namespace trephine::itk {

bool is_identity(const LinearMap& map) { return map.matrix == Mat3{} && map.offset_mm == Vec3{}; }

double apart_mm(const grid::HuVolume& fixed, const LinearMap& a, const LinearMap& b) {
  constexpr float body_hu = -300;
  constexpr int step = 4;
  double largest = 0;
  std::visit(
      [&](const auto& grid) {
        for (int k = 0; k < grid.size[2]; ++k)
          for (int j = 0; j < grid.size[1]; j += step)
            for (int i = 0; i < grid.size[0]; i += step) {
              if (!(grid.at(i, j, k) > body_hu)) continue;
              const Vec3 p = grid.to_world_mm({double(i), double(j), double(k)});
              largest = std::max(largest, norm(a(p) - b(p)));
            }
      },
      fixed);
  return largest;
}

double bone_ratio(const grid::HuVolume& fixed, const grid::HuVolume& moving, const Progress& progress) {
  constexpr double bone_hu = 300, cell_mm = 2, hundredth = 0.01;
  const grid::Lattice &at = grid::lattice_of(fixed), &other = grid::lattice_of(moving);
  // Means over cells of 2 mm, so that neither noise nor what one kernel sharpens counts.
  grid::Lattice cells = at;
  for (int a = 0; a < 3; ++a) {
    const double side = std::max(at.spacing_mm[a], cell_mm);
    cells.size[a] = std::max(1, int(at.size[a] * at.spacing_mm[a] / side));
    cells.spacing_mm[a] = side;
  }
  const auto mean = [&](const grid::HuVolume& volume, const grid::Lattice& l, Vec3 centre) -> std::optional<double> {
    const Vec3 middle = l.to_index(centre);
    int low[3], high[3];
    for (int a = 0; a < 3; ++a) {
      const double half = std::max(0.0, 0.5 * (cells.spacing_mm[a] / l.spacing_mm[a] - 1));
      low[a] = int(std::ceil(middle[a] - half - hundredth)), high[a] = int(std::floor(middle[a] + half + hundredth));
      if (high[a] < low[a]) low[a] = high[a] = int(std::lround(middle[a]));
      if (low[a] < 0 || high[a] >= l.size[a]) return {};
    }
    return std::visit(
        [&](const auto& grid) -> std::optional<double> {
          double sum = 0;
          for (int k = low[2]; k <= high[2]; ++k)
            for (int j = low[1]; j <= high[1]; ++j)
              for (int i = low[0]; i <= high[0]; ++i) sum += grid.at(i, j, k);
          return sum / ((high[0] - low[0] + 1.0) * (high[1] - low[1] + 1.0) * (high[2] - low[2] + 1.0));
        },
        volume);
  };
  std::vector<std::array<std::int64_t, 2>> counts(std::size_t(cells.size[2]));  // bone of both, sum of each one's
  parallel_for(0, cells.size[2], 1, [&](std::int64_t from, std::int64_t to) {
    for (int k = int(from); k < to; ++k) {
      progress.check();
      for (int j = 0; j < cells.size[1]; ++j)
        for (int i = 0; i < cells.size[0]; ++i) {
          const Vec3 p = cells.to_world_mm({double(i), double(j), double(k)});
          const auto here = mean(fixed, at, p), there = mean(moving, other, p);
          if (!here || !there) continue;
          const bool a = *here > bone_hu, b = *there > bone_hu;
          counts[std::size_t(k)][0] += a && b;
          counts[std::size_t(k)][1] += int(a) + int(b);
        }
    }
  });
  std::int64_t both = 0, sum = 0;
  for (const auto& c : counts) both += c[0], sum += c[1];
  return sum > 0 ? 2.0 * double(both) / double(sum) : 0;
}

}  // namespace trephine::itk
