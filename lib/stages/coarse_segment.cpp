// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/coarse_segment.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"

namespace trephine {
namespace {

using Factor = std::array<int, 3>;

Lattice cells_of(const Lattice& fine, double cell_mm, Factor& factor) {
  Lattice cells = fine;
  Vec3 middle;  // of the first cell, in voxels
  for (int a = 0; a < 3; ++a) {
    const double wanted = std::floor(cell_mm / fine.spacing_mm[a] + 1e-6);
    factor[a] = static_cast<int>(std::clamp(wanted, 1.0, double(fine.size[a])));
    cells.size[a] = (fine.size[a] + factor[a] - 1) / factor[a];
    cells.spacing_mm[a] = factor[a] * fine.spacing_mm[a];
    middle[a] = (factor[a] - 1) / 2.0;
  }
  cells.origin_mm = fine.to_world_mm(middle);
  return cells;
}

/// The brightest voxel of each cell; no number where one is none.
template <class T>
Grid<T> brightest(const Grid<T>& fine, const Lattice& lattice, const Factor& factor, const Progress& progress) {
  Grid<T> cells(lattice, std::numeric_limits<T>::lowest());
  parallel_for(0, cells.size[2], 1, [&](std::int64_t first, std::int64_t last) {
    progress.check();
    for (int k = static_cast<int>(first) * factor[2]; k < std::min<std::int64_t>(last * factor[2], fine.size[2]); ++k)
      for (int j = 0; j < fine.size[1]; ++j) {
        const T* from = &fine.at(0, j, k);
        T* to = &cells.at(0, j / factor[1], k / factor[2]);
        for (int i = 0, c = 0; i < fine.size[0]; ++c)
          for (const int end = std::min(i + factor[0], fine.size[0]); i < end; ++i)
            if (!(from[i] <= to[c]) && to[c] == to[c]) to[c] = from[i];
      }
  });
  return cells;
}

/// Each voxel with its cell's value, in the box that the field's cells cover.
Field spread(const Field& field, const Lattice& cells, const Lattice& fine, const Factor& factor) {
  const Box at = place_in(field, cells);
  Box box;
  for (int a = 0; a < 3; ++a) {
    box.begin[a] = at.begin[a] * factor[a];
    box.end[a] = std::min(at.end[a] * factor[a], fine.size[a]);
  }
  Field out(cropped(fine, box));
  parallel_for(0, out.size[2], 4, [&](std::int64_t from, std::int64_t to) {
    for (int k = static_cast<int>(from); k < to; ++k)
      for (int j = 0; j < out.size[1]; ++j) {
        const float* cell = &field.at(0, j / factor[1], k / factor[2]);
        float* voxel = &out.at(0, j, k);
        for (int i = 0; i < out.size[0]; ++cell)
          for (const int end = std::min(i + factor[0], out.size[0]); i < end; ++i) voxel[i] = *cell;
      }
  });
  return out;
}

}  // namespace

Field segment_coarsely(const HuVolume& volume, const SegmentStageParams& params, Report& report,
                       const Progress& progress) {
  Factor factor{};
  const Lattice& fine = lattice_of(volume);
  const Lattice cells = cells_of(fine, params.coarse_mm, factor);
  const HuVolume coarse =
      std::visit([&](const auto& grid) { return HuVolume(brightest(grid, cells, factor, progress)); }, volume);
  // What the cells widened is no wider a bridge.
  SegmentParams p = params;
  double widened_mm = 0;
  for (int a = 0; a < 3; ++a) widened_mm = std::max(widened_mm, (factor[a] - 1) * fine.spacing_mm[a]);
  if (p.open_mm > 0) p.open_mm += widened_mm;
  const Field field = segment(coarse, {}, p, report, progress.part(0.1, 0.9));
  return spread(field, cells, fine, factor);
}

}  // namespace trephine
