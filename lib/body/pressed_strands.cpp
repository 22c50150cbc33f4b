// SPDX-License-Identifier: GPL-3.0-or-later
#include "body/pressed_strands.h"

#include <algorithm>
#include <cmath>

#include "mask/coarse.h"

namespace trephine::body {
namespace {

constexpr double skin_hu = -475;    ///< half of the way from air to skin
constexpr double smooth_mm = 5;     ///< strands and webs are narrower than twice this
constexpr double on_skin_mm = 0.8;  ///< what is nearer to the smoothed body is its own roughness
constexpr double reach_mm = 14;     ///< a mask lies no farther off the skin, but at nose and chin
constexpr double hole_mm = 4;       ///< holes of a mask are narrower than twice this
constexpr double min_hole_mm3 = 2, max_hole_mm3 = 150;
constexpr double thin_mm = 3.2;  ///< a mask is thinner; ears, holders and cushions are thicker
constexpr double cell_mm = 20, min_sheet_mm3 = 60, min_holes_ratio = 0.25, some_holes_ratio = 0.12;
constexpr int min_cells = 16;        ///< unmasked heads have up to 12, masked ones 24 and more
constexpr double min_sheet_ml = 15;  ///< unmasked heads have up to 11, masked ones 37 and more
constexpr int cells_reach = 4;
constexpr double high_base_mm = 7;     ///< from where an ear rises high to its foot
constexpr double thick_mm = 3;         ///< balls of this fit into lips and lids, and not into strands
constexpr double thick_rise_mm = 2.2;  ///< unless the webs of a mask are wide: then they are lower than this
constexpr double bone_hu = 250, min_bone_ml = 1, over_bone_mm = 2.5;
constexpr double rim_mm = 1;  ///< the blurred edge of a strand

mask::BitMask opened(const mask::BitMask& mask, double radius_mm, const Progress& progress) {
  return mask::dilated(mask::eroded(mask, radius_mm, progress), radius_mm, progress);
}

/// What lies within reach of the body, to the cell.
mask::BitMask about(const mask::BitMask& body, const Progress& progress) {
  const mask::CoarseRaster raster = mask::coarse_raster(body.lattice(), reach_mm / 4);
  return mask::fine_mask(mask::dilated(mask::coarse_mask(body, raster, 0), reach_mm, progress), raster);
}

struct Perforated {
  mask::CoarseRaster raster;
  mask::BitMask cells;  ///< in which the sheet has some holes
  int count = 0;        ///< of those with many
};

std::vector<int> count_in_cells(const mask::BitMask& mask, const mask::CoarseRaster& raster) {
  std::vector<int> count(raster.cells.count());
  mask::for_each_voxel(mask::components(mask), [&](int, int i, int j, int k) {
    ++count[raster.cells.index(i / raster.factor[0], j / raster.factor[1], k / raster.factor[2])];
  });
  return count;
}

/// Of what closing a sheet fills, that of which the size is a mask's hole's: a gap between sheet and skin is larger,
/// the sheet's own roughness smaller.
mask::BitMask perforations(const mask::BitMask& filled) {
  const mask::Components pieces = mask::components(filled);
  std::vector<char> keep(pieces.list.size());
  for (std::size_t c = 0; c < keep.size(); ++c) {
    const double mm3 = double(pieces.list[c].voxels) * filled.lattice().voxel_volume_mm3();
    keep[c] = mm3 >= min_hole_mm3 && mm3 <= max_hole_mm3;
  }
  return mask::select(pieces, keep);
}

Perforated perforated(const mask::BitMask& sheet, const mask::BitMask& inside, const Progress& progress) {
  Perforated out{mask::coarse_raster(sheet.lattice(), cell_mm), {}, 0};
  out.cells = mask::BitMask(out.raster.cells);
  const mask::BitMask holes =
      perforations(mask::without(mask::without(mask::closed(sheet, hole_mm, progress), sheet), inside));
  const std::vector<int> full = count_in_cells(sheet, out.raster), empty = count_in_cells(holes, out.raster);
  const double voxel_mm3 = sheet.lattice().voxel_volume_mm3();
  const auto& size = out.raster.cells.size;
  for (int k = 0; k < size[2]; ++k)
    for (int j = 0; j < size[1]; ++j)
      for (int i = 0; i < size[0]; ++i) {
        const std::size_t c = out.raster.cells.index(i, j, k);
        if (full[c] * voxel_mm3 < min_sheet_mm3 || empty[c] < some_holes_ratio * full[c]) continue;
        out.cells.set(i, j, k);
        out.count += empty[c] >= min_holes_ratio * full[c];
      }
  return out;
}

/// The voxels within cells_reach steps of the cells with holes: where the mask lies close, nothing of it stands out of
/// the skin far enough to be counted.
mask::BitMask near_cells(const Perforated& p) {
  mask::BitMask cells = p.cells;
  for (int step = 0; step < cells_reach; ++step) cells = mask::dilated_6(cells);
  return mask::fine_mask(cells, p.raster);
}

}  // namespace

PressedStrands find_pressed_strands(const mask::HuView& hu, const mask::BitMask& whole, const mask::BitMask& body,
                                    double most_mm, const Progress& progress) {
  PressedStrands out;
  out.strands = mask::BitMask(body.lattice());
  const Vec3 spacing = body.lattice().spacing_mm;
  const int margin = int(std::ceil(reach_mm / std::min({spacing.x, spacing.y, spacing.z})));
  const grid::Box box = grid::grown(body.bounds(), margin, body.lattice());
  const mask::BitMask skin = mask::crop(mask::above(hu, skin_hu), box), edged = mask::crop(body, box);
  mask::BitMask solid = mask::crop(whole, box);
  solid |= mask::both(skin, edged);
  const mask::BitMask smooth = opened(solid, smooth_mm, progress);
  const mask::BitMask inside = mask::dilated(smooth, on_skin_mm, progress);
  mask::BitMask sheet = mask::both(mask::without(skin, inside), about(solid, progress));
  sheet.remove(mask::dilated(mask::eroded(sheet, thin_mm / 2, progress), thin_mm / 2 + on_skin_mm, progress));
  const Perforated holey = perforated(sheet, inside, progress);
  out.cells_count = holey.count;
  out.sheet_ml = double(sheet.count()) * sheet.lattice().voxel_volume_mm3() / 1000;
  out.found = holey.count >= min_cells && out.sheet_ml >= min_sheet_ml;
  if (!out.found) return out;

  const mask::BitMask relief = mask::both(mask::without(solid, smooth), near_cells(holey));
  mask::BitMask keep = mask::grown_within(mask::without(relief, mask::dilated(smooth, most_mm, progress)), relief,
                                          high_base_mm, progress);
  const mask::BitMask thick = mask::both(opened(solid, thick_mm, progress), relief);
  keep |= mask::grown_within(mask::without(thick, mask::dilated(smooth, thick_rise_mm, progress)), thick, thick_mm,
                             progress);
  const mask::BitMask bone =
      mask::at_least_ml(mask::components(mask::both(mask::crop(mask::above(hu, bone_hu), box), solid)), min_bone_ml);
  keep |= mask::dilated(bone, over_bone_mm, progress);
  const mask::BitMask strands = mask::without(relief, keep);
  mask::BitMask off = mask::dilated(strands, rim_mm, progress);
  off &= mask::without(mask::without(mask::without(edged, solid), inside), keep);
  off |= strands;
  out.strands = mask::placed(off, body.lattice());
  return out;
}

}  // namespace trephine::body
