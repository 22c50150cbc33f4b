// SPDX-License-Identifier: GPL-3.0-or-later
#include "segmentation/coarse_segment.h"

#include <algorithm>
#include <limits>

#include "base/parallel.h"
#include "mask/coarse.h"

namespace trephine::segmentation {
namespace {

/// The brightest voxel of each cell; NaN where one of them is NaN.
template <class T>
grid::Grid<T> brightest(const grid::Grid<T>& fine, const mask::CoarseRaster& raster, const Progress& progress) {
  const auto& factor = raster.factor;
  grid::Grid<T> cells(raster.cells, std::numeric_limits<T>::lowest());
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

/// Gives each voxel its cell's value, in the box that the field's cells cover.
grid::Field spread(const grid::Field& field, const mask::CoarseRaster& raster) {
  const auto& factor = raster.factor;
  const grid::Box at = grid::place_in(field, raster.cells);
  grid::Box box;
  for (int a = 0; a < 3; ++a) {
    box.begin[a] = at.begin[a] * factor[a];
    box.end[a] = std::min(at.end[a] * factor[a], raster.fine.size[a]);
  }
  grid::Field out(grid::cropped(raster.fine, box));
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

Outcome<grid::Field, SegmentResult> segment_coarsely(const grid::HuVolume& volume, const SegmentParams& params,
                                                     const Progress& progress) {
  const mask::CoarseRaster raster = mask::coarse_raster(grid::lattice_of(volume), params.coarse_mm, true);
  const grid::HuVolume coarse =
      std::visit([&](const auto& grid) { return grid::HuVolume(brightest(grid, raster, progress)); }, volume);
  // A bridge must not count as wider because cells are coarse.
  SegmentParams p = params;
  p.coarse_mm = 0;
  double widened_mm = 0;
  for (int a = 0; a < 3; ++a) widened_mm = std::max(widened_mm, (raster.factor[a] - 1) * raster.fine.spacing_mm[a]);
  if (p.open_mm > 0) p.open_mm += widened_mm;
  auto made = segment(coarse, {}, p, progress.part(0.1, 0.9));
  made.value = spread(made.value, raster);
  return made;
}

}  // namespace trephine::segmentation
