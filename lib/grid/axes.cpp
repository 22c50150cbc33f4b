// SPDX-License-Identifier: GPL-3.0-or-later
#include "grid/axes.h"

#include <algorithm>

#include "base/error.h"

namespace trephine::grid {
namespace {

Mat3 directions_of(const std::string& axes) {
  constexpr const char* pairs[] = {"LR", "PA", "SI"};
  Mat3 direction;
  bool used[3] = {false, false, false};
  bool good = axes.size() == 3;
  for (std::size_t n = 0; good && n < 3; ++n) {
    good = false;
    for (int a = 0; a < 3; ++a) {
      if (used[a] || (axes[n] != pairs[a][0] && axes[n] != pairs[a][1])) continue;
      used[a] = good = true;
      Vec3 d{0, 0, 0};
      d[a] = axes[n] == pairs[a][0] ? 1 : -1;
      direction.column[n] = d;
      break;
    }
  }
  if (!good)
    throw Error(ExitCode::usage, "", "axes",
                "must be three letters, one each of L or R, P or A, S or I, such as LPS: the sides of the patient to "
                "which columns, rows and slices rise");
  return direction;
}

}  // namespace

HuVolume with_axes(HuVolume volume, const std::string& axes) {
  Mat3 direction = directions_of(axes);
  std::visit(
      [&](auto& g) {
        const Vec3 half{0.5 * (g.size[0] - 1), 0.5 * (g.size[1] - 1), 0.5 * (g.size[2] - 1)};
        const Vec3 middle = g.to_world_mm(half);
        if (determinant(direction) < 0) {
          direction.column[2] = -direction.column[2];
          const auto slice = std::ptrdiff_t(g.size[0]) * g.size[1];
          for (int k = 0; k < g.size[2] / 2; ++k)
            std::swap_ranges(g.voxels.begin() + k * slice, g.voxels.begin() + (k + 1) * slice,
                             g.voxels.begin() + (g.size[2] - 1 - k) * slice);
        }
        g.direction = direction;
        g.origin_mm = {0, 0, 0};
        g.origin_mm = middle - g.to_world_mm(half);
      },
      volume);
  return volume;
}

}  // namespace trephine::grid
