// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/cell_rows.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

#include "base/parallel.h"

namespace trephine::surface {
namespace {

constexpr std::int64_t grain = 16384;
/// How far a triangle may reach beyond its cell, in cells; and how many rows there may be for each triangle.
constexpr double most_beyond = 0.25;
constexpr double rows_each = 64;

}  // namespace

std::optional<CellRows> CellRows::of(const TriMesh& mesh, const grid::Lattice& lattice) {
  const auto count = static_cast<std::int64_t>(mesh.triangles.size());
  if (count == 0) return {};
  struct Cell {
    std::int32_t j, k;
  };
  CellRows made;
  made.cell_.resize(count);
  made.boxes_.resize(count);
  std::vector<Cell> cells(count);
  std::atomic<bool> fits{true};
  parallel_for(0, count, grain, [&](std::int64_t from, std::int64_t to) {
    for (std::int64_t t = from; t < to; ++t) {
      std::array<Vec3, 3> p;
      for (int c = 0; c < 3; ++c) {
        made.boxes_[t].add(mesh.points_mm[mesh.triangles[t][c]]);
        p[c] = lattice.to_index(mesh.world_mm(mesh.triangles[t][c]));
      }
      const Vec3 centre = (p[0] + p[1] + p[2]) / 3;
      std::array<std::int32_t, 3> cell;
      for (int a = 0; a < 3; ++a) {
        const double low = std::floor(centre[a]);
        const auto [least, most] = std::minmax({p[0][a], p[1][a], p[2][a]});
        if (!(std::abs(low) < 1e9) || least < low - most_beyond || most > low + 1 + most_beyond)
          return void(fits = false);
        cell[a] = static_cast<std::int32_t>(low);
      }
      made.cell_[t] = cell[0];
      cells[t] = {cell[1], cell[2]};
    }
  });
  if (!fits) return {};
  const auto [low, high] = std::minmax_element(cells.begin(), cells.end(), [](Cell a, Cell b) { return a.j < b.j; });
  const std::int32_t first_j = low->j, first_k = cells.front().k;
  const std::int64_t along = std::int64_t(high->j) - first_j + 1, layers = std::int64_t(cells.back().k) - first_k + 1;
  if (layers < 1 || double(along) * double(layers) > rows_each * double(count) + 1e6) return {};
  made.along_ = static_cast<int>(along);
  made.first_.assign(along * layers + 1, 0);
  std::int64_t before = -1;
  for (std::int64_t t = 0; t < count; ++t) {
    const std::int64_t row = (std::int64_t(cells[t].k) - first_k) * along + cells[t].j - first_j;
    if (row < before || row >= along * layers || (row == before && made.cell_[t] < made.cell_[t - 1])) return {};
    before = row;
    ++made.first_[row + 1];
  }
  for (std::size_t n = 1; n < made.first_.size(); ++n) made.first_[n] += made.first_[n - 1];
  return made;
}

}  // namespace trephine::surface
