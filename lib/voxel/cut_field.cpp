// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/parallel.h"
#include "base/rank.h"
#include "voxel/cut.h"
#include "voxel/cut_solid.h"

namespace trephine::voxel {
namespace {

constexpr double margin_voxels = 3;
const Warning nothing{"removes_nothing", "removes nothing of the field", {}};

// Length of the field's gradient, per mm, at the voxels of the box that the surface passes; by central differences.
std::vector<double> slopes_at_surface(const grid::Field& field, const grid::Box& box) {
  std::vector<double> slopes;
  const auto at = [&](std::array<int, 3> v) { return double(field.at(v[0], v[1], v[2])); };
  for (int k = box.begin[2]; k < box.end[2]; ++k)
    for (int j = box.begin[1]; j < box.end[1]; ++j)
      for (int i = box.begin[0]; i < box.end[0]; ++i) {
        const std::array<int, 3> here{i, j, k};
        const bool inside = at(here) > 0;
        bool crossed = false;
        Vec3 slope;
        for (std::size_t a = 0; a < 3; ++a) {
          auto before = here, after = here;
          before[a] = std::max(0, here[a] - 1);
          after[a] = std::min(field.size[a] - 1, here[a] + 1);
          crossed = crossed || (at(before) > 0) != inside || (at(after) > 0) != inside;
          const int steps = after[a] - before[a];
          slope[int(a)] = steps > 0 ? (at(after) - at(before)) / (steps * field.spacing_mm[int(a)]) : 0;
        }
        const double length = norm(slope);
        if (crossed && length > 0 && std::isfinite(length)) slopes.push_back(length);
      }
  return slopes;
}

// The field's slope per mm: near the solid; where it has no surface there, on all of its surface; else 1.
double unit_per_mm(const grid::Field& field, const grid::Box& box) {
  std::vector<double> slopes = slopes_at_surface(field, box);
  if (slopes.empty()) slopes = slopes_at_surface(field, grid::whole_box(field));
  return slopes.empty() ? 1 : median_of(slopes);
}

}  // namespace

Outcome<std::monostate, CutFieldResult> cut_field(grid::Field& field, const surface::DistanceFunction& solid,
                                                  const surface::Bounds& solid_bounds_mm, const Progress& progress) {
  const grid::Box box = detail::box_of(field, solid_bounds_mm, {margin_voxels, margin_voxels, margin_voxels});
  if (box.empty()) {
    return {{}, {}, {nothing}};
  }
  const double unit = unit_per_mm(field, box);
  // Voxels lowered, and those of them that were inside.
  std::vector<std::size_t> changed(std::size_t(box.end[2] - box.begin[2]), 0), inside = changed;
  parallel_for(box.begin[2], box.end[2], 1, [&](std::int64_t from, std::int64_t) {
    const int k = int(from);
    progress.check();
    for (int j = box.begin[1]; j < box.end[1]; ++j)
      for (int i = box.begin[0]; i < box.end[0]; ++i) {
        float& f = field.at(i, j, k);
        const double limit = unit * solid(field.to_world_mm({double(i), double(j), double(k)}));
        if (!(limit < double(f))) continue;
        inside[std::size_t(k - box.begin[2])] += f > 0;
        f = float(std::max(limit, -1e30));
        ++changed[std::size_t(k - box.begin[2])];
      }
  });
  const auto sum = [](const std::vector<std::size_t>& v) {
    return std::accumulate(v.begin(), v.end(), std::size_t{0});
  };
  progress.report(1);
  return {{}, {sum(changed), unit}, sum(inside) == 0 ? Warnings{nothing} : Warnings{}};
}

}  // namespace trephine::voxel
