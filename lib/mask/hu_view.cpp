// SPDX-License-Identifier: GPL-3.0-or-later
#include "mask/hu_view.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <limits>

#include "base/error.h"
#include "base/parallel.h"
#include "base/refusal.h"
#include "mask/filters.h"
#include "surface/bounds.h"

namespace trephine::mask {

BitMask above(const HuView& hu, double threshold) {
  // No sample lies between them.
  float level = float(threshold);
  if (double(level) > threshold) level = std::nextafter(level, -std::numeric_limits<float>::infinity());
  return make_mask(hu.lattice(), [&](int j, int k, std::uint8_t* row) {
    constexpr int together = 64;  // read first and compared then, which is one instruction for several
    const int n = hu.lattice().size[0];
    const std::size_t first = hu.lattice().index(0, j, k);
    for (int i = 0; i < n; i += together) {
      const int some = std::min(together, n - i);
      float value[together];
      for (int b = 0; b < some; ++b) value[b] = hu(first + std::size_t(i + b));
      for (int b = 0; b < some; ++b) row[i + b] = value[b] > level;
    }
  });
}

grid::Grid<float> crop(const HuView& hu, const grid::Box& box) {
  grid::Grid<float> out(grid::cropped(hu.lattice(), box));
  parallel_for(0, out.size[2], 4, [&](std::int64_t from, std::int64_t to) {
    for (int k = int(from); k < to; ++k)
      for (int j = 0; j < out.size[1]; ++j) {
        const std::size_t in = hu.lattice().index(box.begin[0], j + box.begin[1], k + box.begin[2]);
        float* o = &out.at(0, j, k);
        for (int i = 0; i < out.size[0]; ++i) o[i] = hu(in + i);
      }
  });
  return out;
}

grid::Box region_of_interest(const grid::Lattice& lattice, const std::array<double, 3>& roi_min_mm,
                             const std::array<double, 3>& roi_max_mm) {
  const Vec3 lo{roi_min_mm[0], roi_min_mm[1], roi_min_mm[2]};
  const Vec3 hi{roi_max_mm[0], roi_max_mm[1], roi_max_mm[2]};
  for (int axis = 0; axis < 3; ++axis)
    if (lo[axis] > hi[axis])
      throw Error(ExitCode::usage, "", "roi_min_mm, roi_max_mm",
                  fmt::format("{} to {} mm along {}: the lower corner must not be beyond the upper", lo[axis], hi[axis],
                              "xyz"[axis]));
  // The box of indices around the eight corners: exact for volumes along the axes, the enclosing box for oblique ones.
  const auto [least, most] = surface::index_bounds(lattice, {lo, hi});
  grid::Box box = grid::whole_box(lattice);
  for (int axis = 0; axis < 3; ++axis) {
    box.begin[axis] = int(std::clamp(std::ceil(least[axis] - 1e-6), 0.0, double(lattice.size[axis])));
    box.end[axis] = int(std::clamp(std::floor(most[axis] + 1e-6) + 1, 0.0, double(lattice.size[axis])));
  }
  if (box.empty())
    throw refusal("roi_min_mm, roi_max_mm", "0 voxels of the volume lie between them",
                  {"move `roi_min_mm` and `roi_max_mm` into the volume"});
  return box;
}

BitMask holes(const BitMask& shape, const FillRule& rule, const Progress& progress) {
  BitMask free = shape;
  free.invert();
  BitMask open = rule.close_mm > 0 ? closed(shape, rule.close_mm, progress) : shape;
  open.invert();
  const Components spaces = components(open);
  const double voxel_ml = shape.lattice().voxel_volume_mm3() / 1000;
  std::vector<char> outside(spaces.list.size());
  for (std::size_t c = 0; c < outside.size(); ++c) {
    const Component& space = spaces.list[c];
    outside[c] = space.faces > (rule.cut_open ? 1 : 0) || space.voxels * voxel_ml > rule.max_ml;
  }
  BitMask reached = select(spaces, outside);
  if (rule.close_mm > 0) reached = grown_within(reached, free, rule.close_mm, progress);
  return free.remove(reached);
}

const Remedy other_thresholds{
    "set `lower_hu` and `upper_hu` so that the tissue lies between them, or paint it and bring it back by the stage "
    "`labels`"};

const Remedy wider_or_other_thresholds{
    "where the scan lies wholly inside it, leave it out of the scene, or take a scan with a wider field of view; else "
    "set `lower_hu` and `upper_hu` so that the tissue lies between them, or paint it and bring it back by the stage "
    "`labels`"};

MaskSize check_mask(const BitMask& mask, std::size_t volume_voxels) {
  const std::size_t n = mask.count();
  if (n == 0) throw refusal("", fmt::format("the mask is empty: 0 of {} voxels", volume_voxels), other_thresholds);
  if (n == volume_voxels)
    throw refusal("", fmt::format("the mask is full: all {} voxels", n), wider_or_other_thresholds);
  const grid::Box b = mask.bounds();
  for (int axis = 0; axis < 3; ++axis)
    if (b.end[axis] - b.begin[axis] < 2)
      throw refusal("", fmt::format("the mask lies in a single slice: {} voxels", n), other_thresholds);
  return {n, double(n) * mask.lattice().voxel_volume_mm3() / 1000};
}

void check_varies(const grid::HuVolume& volume) {
  std::visit(
      [](const auto& grid) {
        const auto& v = grid.voxels;
        if (std::adjacent_find(v.begin(), v.end(), std::not_equal_to<>()) == v.end())
          throw refusal("volume",
                        fmt::format("every voxel is {} HU: there is nothing to be seen in it", v.empty() ? 0 : v[0]),
                        {"take another series (`import --list` shows all)"});
      },
      volume);
}

void check_finite(const grid::HuVolume& volume) {
  const auto* grid = std::get_if<grid::Grid<float>>(&volume);
  if (!grid) return;
  std::atomic<std::size_t> bad{0};
  parallel_for(0, std::int64_t(grid->voxels.size()), 1 << 20, [&](std::int64_t from, std::int64_t to) {
    std::size_t n = 0;
    for (std::int64_t v = from; v < to; ++v) n += !std::isfinite(grid->voxels[v]);
    bad += n;
  });
  if (bad > 0) throw Error(ExitCode::bad_input, "", "volume", fmt::format("{} voxels are NaN or infinite", bad.load()));
}

}  // namespace trephine::mask
