// SPDX-License-Identifier: GPL-3.0-or-later
#include "touch/far_field.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace trephine::touch {
namespace {

constexpr double smallest_cell_mm = 0.5, pad_mm = 4, most_cells = 2e6;
constexpr double rounding_mm = 1e-3;  // of floats

}  // namespace

FarField::FarField(const surface::TriMesh& mesh, const surface::TriangleTree& tree) {
  surface::Bounds all;
  for (std::size_t n = 0; n < mesh.points_mm.size(); ++n)
    for (int a = 0; a < 3; ++a) {
      all.min_mm[a] = std::min(all.min_mm[a], mesh.points_mm[n][a]);
      all.max_mm[a] = std::max(all.max_mm[a], mesh.points_mm[n][a]);
    }
  const Vec3 pad{pad_mm, pad_mm, pad_mm}, extent = all.max_mm - all.min_mm + pad * 2;
  low_ = all.min_mm - pad;
  cell_mm_ = std::max(smallest_cell_mm, std::cbrt(extent.x * extent.y * extent.z / most_cells));
  cells_per_mm_ = 1 / cell_mm_;
  for (int a = 0; a < 3; ++a) size_[std::size_t(a)] = int(std::ceil(extent[a] / cell_mm_)) + 1;
  least_.resize(std::size_t(size_[0]) * std::size_t(size_[1]) * std::size_t(size_[2]));
  const double half = 0.5 * std::sqrt(3.0) * cell_mm_, limit = pad_mm + half;
  parallel_for(0, std::int64_t(size_[1]) * size_[2], 16, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t row = begin; row < end; ++row)
      for (int i = 0; i < size_[0]; ++i) {
        const std::int64_t j = row % size_[1], k = row / size_[1];
        const Vec3 middle = low_ + Vec3{i + 0.5, double(j) + 0.5, double(k) + 0.5} * cell_mm_;
        const double distance = std::sqrt(tree.squared_distance(middle, limit * limit));
        least_[std::size_t(row) * std::size_t(size_[0]) + std::size_t(i)] =
            float(std::max(0.0, distance - half - rounding_mm));
      }
  });
}

// Beyond the cells the mesh is farther than its pad.
double FarField::beyond_mm(Vec3 cells) const {
  double beyond = 0;
  for (int a = 0; a < 3; ++a) beyond = std::max({beyond, -cells[a], cells[a] - size_[std::size_t(a)]});
  return pad_mm - rounding_mm + beyond * cell_mm_;
}

}  // namespace trephine::touch
