// SPDX-License-Identifier: GPL-3.0-or-later
#include "publish/ct_content.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace trephine::publish {
namespace {

grid::Grid<std::int16_t> to_int16(const grid::Grid<std::int16_t>& grid) { return grid; }

grid::Grid<std::int16_t> to_int16(const grid::Grid<float>& grid) {
  grid::Grid<std::int16_t> out(static_cast<const grid::Lattice&>(grid));
  for (std::size_t i = 0; i < out.voxels.size(); ++i)
    out.voxels[i] = static_cast<std::int16_t>(std::clamp(std::round(grid.voxels[i]), -32768.f, 32767.f));
  return out;
}

// Calls f for the eight corners.
template <class F>
void each_corner(const surface::Bounds& b, F&& f) {
  for (int corner = 0; corner < 8; ++corner)
    f(Vec3{corner & 1 ? b.max_mm.x : b.min_mm.x, corner & 2 ? b.max_mm.y : b.min_mm.y,
           corner & 4 ? b.max_mm.z : b.min_mm.z});
}

}  // namespace

surface::Bounds bounds_of_lattice(const grid::Lattice& lattice) {
  surface::Bounds indices, out;
  indices.min_mm = {0, 0, 0};
  indices.max_mm = {lattice.size[0] - 1.0, lattice.size[1] - 1.0, lattice.size[2] - 1.0};
  each_corner(indices, [&](Vec3 index) {
    const Vec3 at = lattice.to_world_mm(index);
    for (int k = 0; k < 3; ++k) {
      out.min_mm[k] = std::min(out.min_mm[k], at[k]);
      out.max_mm[k] = std::max(out.max_mm[k], at[k]);
    }
  });
  return out;
}

grid::Grid<std::int16_t> published_ct(const grid::HuVolume& scan, const surface::Bounds& shown, double margin_mm) {
  const grid::Lattice& lattice = grid::lattice_of(scan);
  surface::Bounds grown = shown;
  for (int k = 0; k < 3; ++k) {
    grown.min_mm[k] -= margin_mm;
    grown.max_mm[k] += margin_mm;
  }
  Vec3 low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
  each_corner(grown, [&](Vec3 at) {
    const Vec3 index = lattice.to_index(at);
    for (int k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], index[k]);
      high[k] = std::max(high[k], index[k]);
    }
  });
  grid::Box box;
  for (int k = 0; k < 3; ++k) {
    box.begin[k] = static_cast<int>(std::clamp(std::floor(low[k]), 0.0, double(lattice.size[k])));
    box.end[k] = static_cast<int>(std::clamp(std::ceil(high[k]) + 1, 0.0, double(lattice.size[k])));
  }
  if (box.empty()) throw Error(ExitCode::internal, "", "ct", "the scan holds nothing of what is shown");
  return std::visit([&](const auto& grid) { return to_int16(grid::crop(grid, box)); }, scan);
}

}  // namespace trephine::publish
