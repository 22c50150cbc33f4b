// SPDX-License-Identifier: GPL-3.0-or-later
#include "touch/facet_cells.h"

#include <algorithm>
#include <cmath>

namespace trephine::touch {
namespace {

constexpr double smallest_cell_mm = 0.25, widest_cell_mm = 8, reach_cells = 0.8;
constexpr double most_cells = 4e6, most_facets = 8e6;
constexpr double rounding_mm = 1e-3;  // of floats

}  // namespace

FacetCells::FacetCells(const surface::TriangleTree& tree, double skin_mm) {
  surface::FloatBox all;
  for (std::size_t n = 0; n < tree.order().size(); ++n) all.add(tree.box(n));
  double volume = 1;
  for (std::size_t a = 0; a < 3; ++a) volume *= double(all.max[a]) - double(all.min[a]) + 2;
  for (double cell = std::max(smallest_cell_mm, std::cbrt(volume / most_cells)); cell < widest_cell_mm; cell *= 1.5)
    if (fill(tree, all, skin_mm, cell)) return;
}

// False, and nothing is known, where there would be too many.
bool FacetCells::fill(const surface::TriangleTree& tree, const surface::FloatBox& all, double skin_mm, double cell_mm) {
  cells_per_mm_ = 1 / cell_mm;
  reach_mm_ = reach_cells * cell_mm;
  const double reach = reach_mm_ + skin_mm + rounding_mm;
  std::size_t cells = 1;
  for (int a = 0; a < 3; ++a) {  // a way that begins beyond these cells comes near nothing
    const auto n = std::size_t(a);
    low_[a] = double(all.min[n]) - reach;
    size_[n] = int(std::ceil((double(all.max[n]) + reach - low_[a]) * cells_per_mm_)) + 1;
    cells *= std::size_t(size_[n]);
  }
  const auto for_cells = [&](std::size_t facet, const auto& look) {
    const surface::FloatBox& box = tree.box(facet);
    std::size_t begin[3], end[3];
    for (std::size_t a = 0; a < 3; ++a) {
      const double low = low_[int(a)];
      begin[a] = std::size_t(std::max(0.0, (double(box.min[a]) - reach - low) * cells_per_mm_));
      end[a] = std::min(std::size_t(size_[a]), std::size_t((double(box.max[a]) + reach - low) * cells_per_mm_) + 1);
    }
    for (std::size_t k = begin[2]; k < end[2]; ++k)
      for (std::size_t j = begin[1]; j < end[1]; ++j)
        for (std::size_t i = begin[0]; i < end[0]; ++i)
          look((k * std::size_t(size_[1]) + j) * std::size_t(size_[0]) + i);
  };
  first_.assign(cells + 1, 0);
  std::size_t count = 0;
  for (std::size_t n = 0; n < tree.order().size(); ++n) {
    for_cells(n, [&](std::size_t cell) {
      ++first_[cell + 1];
      ++count;
    });
    if (double(count) <= most_facets) continue;
    first_.clear();
    return false;
  }
  for (std::size_t c = 0; c < cells; ++c) first_[c + 1] += first_[c];
  facet_.resize(count);
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (std::size_t n = 0; n < tree.order().size(); ++n)
    for_cells(n, [&](std::size_t cell) { facet_[next[cell]++] = std::uint32_t(n); });
  return true;
}

}  // namespace trephine::touch
