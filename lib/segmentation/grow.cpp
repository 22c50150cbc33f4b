// SPDX-License-Identifier: GPL-3.0-or-later
#include "segmentation/grow.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/error.h"

namespace trephine::segmentation {

grid::Mask grow_in_ball(const grid::HuVolume& volume, const GrowRequest& request) {
  const grid::Lattice& lattice = grid::lattice_of(volume);
  const int i0 = request.seed[0], j0 = request.seed[1], k0 = request.seed[2];
  if (!lattice.contains(i0, j0, k0)) throw Error(ExitCode::usage, "", "seed", "is no voxel of the scan");
  if (!(request.radius_mm > 0 && request.radius_mm <= 200))
    throw Error(ExitCode::usage, "", "radius_mm", "must be above 0 and at most 200");
  if (!(request.lower_hu <= request.upper_hu)) throw Error(ExitCode::usage, "", "lower_hu", "must not exceed upper_hu");
  grid::Box box;
  for (int a = 0; a < 3; ++a) {
    const int reach = int(request.radius_mm / lattice.spacing_mm[a]);
    box.begin[a] = std::max(0, request.seed[std::size_t(a)] - reach);
    box.end[a] = std::min(lattice.size[std::size_t(a)], request.seed[std::size_t(a)] + reach + 1);
  }
  grid::Mask out(grid::cropped(lattice, box));
  const Vec3 centre = lattice.to_world_mm({double(i0), double(j0), double(k0)});
  std::visit(
      [&](const auto& grid) {
        const auto fits = [&](int i, int j, int k) {
          const int x = i + box.begin[0], y = j + box.begin[1], z = k + box.begin[2];
          const double hu = double(grid.at(x, y, z));
          return hu >= request.lower_hu && hu <= request.upper_hu &&
                 norm(lattice.to_world_mm({double(x), double(y), double(z)}) - centre) <= request.radius_mm;
        };
        std::vector<std::array<int, 3>> open = {{i0 - box.begin[0], j0 - box.begin[1], k0 - box.begin[2]}};
        if (!fits(open[0][0], open[0][1], open[0][2]))
          throw Error(ExitCode::usage, "", "seed", "the voxel that was clicked is not in the range of HU");
        out.at(open[0][0], open[0][1], open[0][2]) = 1;
        while (!open.empty()) {
          const auto [i, j, k] = open.back();
          open.pop_back();
          const int next[6][3] = {{i - 1, j, k}, {i + 1, j, k}, {i, j - 1, k},
                                  {i, j + 1, k}, {i, j, k - 1}, {i, j, k + 1}};
          for (const auto& n : next)
            if (out.contains(n[0], n[1], n[2]) && !out.at(n[0], n[1], n[2]) && fits(n[0], n[1], n[2])) {
              out.at(n[0], n[1], n[2]) = 1;
              open.push_back({n[0], n[1], n[2]});
            }
        }
      },
      volume);
  return out;
}

}  // namespace trephine::segmentation
