// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "mask/inside_box.h"
#include "picture/slice.h"
#include "publish/case_pictures.h"

namespace trephine::publish {
namespace {

constexpr int cell_px = 640, cells = 6;
constexpr double least_ml = 0.5;
constexpr float min_hu = 100;  // what lost less is not called removed

// Where the scan lost at least min_hu, on every second voxel of a slice: an outline needs no more.
grid::Field lost(const ScanOnce& before, const ScanOnce& after, const std::string& name) {
  constexpr int step = 2;
  grid::Field out;
  const auto each_voxel = [&](const grid::HuVolume& scan, const auto& set) {
    std::visit(
        [&](const auto& hu) {
          parallel_for(0, out.size[2], 4, [&](std::int64_t begin, std::int64_t end) {
            for (auto k = int(begin); k < end; ++k)
              for (int j = 0; j < out.size[1]; ++j)
                for (int i = 0; i < out.size[0]; ++i) set(out.at(i, j, k), float(hu.at(step * i, step * j, k)));
          });
        },
        scan);
  };
  grid::Lattice whole;
  {
    const auto scan = before();
    whole = grid::lattice_of(*scan);
    grid::Lattice l = whole;
    for (int a = 0; a < 2; ++a) {
      l.size[a] = (l.size[a] + step - 1) / step;
      l.spacing_mm[a] *= step;
    }
    out = grid::Field(l);
    each_voxel(*scan, [](float& v, float hu) { v = hu; });
  }
  const auto scan = after();
  if (whole != grid::lattice_of(*scan)) throw Error(ExitCode::internal, "", name, "does not keep the scan's voxels");
  each_voxel(*scan, [](float& v, float hu) { v = v - hu - min_hu; });
  return out;
}

}  // namespace

std::optional<CasePicture> make_removed_picture(const ScanOnce& before, const ScanOnce& after, const std::string& name,
                                                const Progress& progress) {
  const grid::Field missing = lost(before, after, name);
  const auto count = std::count_if(missing.voxels.begin(), missing.voxels.end(), [](float v) { return v > 0; });
  if (double(count) * missing.voxel_volume_mm3() / 1000 < least_ml) return {};
  const grid::Box box = mask::inside_box(missing);
  const auto scan = before();
  std::vector<picture::Image> images(cells);
  parallel_for(0, cells, 1, [&](std::int64_t from, std::int64_t to) {
    for (auto i = from; i < to; ++i) {
      progress.check();
      // Four axial slices through what is missing, then its middle from the front and from the side.
      constexpr double along[cells] = {0.2, 0.4, 0.6, 0.8, 0.5, 0.5};
      Vec3 at;
      for (int a = 0; a < 3; ++a) at[a] = box.begin[a] + along[i] * (box.end[a] - 1 - box.begin[a]);
      const Vec3 place = missing.to_world_mm(at);
      picture::SliceParams params;
      params.longer_side_px = cell_px;
      params.window_center_hu = -300;  // apparatus is foam and plastic, between air and tissue
      params.window_width_hu = 1400;
      params.plane = i < 4    ? picture::SlicePlane::axial
                     : i == 4 ? picture::SlicePlane::coronal
                              : picture::SlicePlane::sagittal;
      params.position_mm = i < 4 ? place.z : i == 4 ? place.y : place.x;
      images[std::size_t(i)] =
          picture::slice_overlay(*scan, params, {{nullptr, {1, 0.25, 0.1}, "taken off", &missing}});
    }
  });
  return CasePicture{"removed_by_" + name + ".png", picture::encode_png(picture::contact_sheet(images, 3))};
}

}  // namespace trephine::publish
