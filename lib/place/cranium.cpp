// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/error.h"
#include "base/parallel.h"
#include "base/refusal.h"
#include "mask/coarse.h"
#include "mask/coarse_share.h"
#include "mask/filters.h"
#include "place/cranium.h"

namespace trephine::place {
namespace {

constexpr double coarse_mm = 2;
constexpr double min_core_mm = 15;     ///< the centre of a cranium lies at least this far from bone
constexpr double min_enclosure = 0.6;  ///< and in this share of directions a ray from it meets bone
constexpr double opening_mm = 2;
constexpr double canal_mm = 13;   ///< the spinal canal is narrower than twice this, the foramen magnum about as wide
constexpr double corner_mm = 10;  ///< how far corners (and the canal's beginning) reach beyond the balls of that radius

/// In how many of 26 directions a ray from each cell of the box, which holds all bone, meets bone.
grid::Mask rays_met(const mask::BitMask& bone, const grid::Box& box) {
  grid::Mask count(grid::cropped(bone.lattice(), box)), meets(count);
  const auto [nx, ny, nz] = count.size;
  for (int dk = -1; dk <= 1; ++dk)
    for (int dj = -1; dj <= 1; ++dj)
      for (int di = -1; di <= 1; ++di) {
        if (!di && !dj && !dk) continue;
        // A ray meets what the ray of the next cell meets, so the cells come from the far end of the direction on.
        for (int c = 0; c < nz; ++c)
          for (int b = 0; b < ny; ++b)
            for (int a = 0; a < nx; ++a) {
              const int i = di > 0 ? nx - 1 - a : a, j = dj > 0 ? ny - 1 - b : b, k = dk > 0 ? nz - 1 - c : c;
              const int x = i + di, y = j + dj, z = k + dk;
              const bool inside = x >= 0 && y >= 0 && z >= 0 && x < nx && y < ny && z < nz;
              const bool met =
                  inside && (meets.at(x, y, z) || bone.get(x + box.begin[0], y + box.begin[1], z + box.begin[2]));
              meets.at(i, j, k) = met;
              count.at(i, j, k) = std::uint8_t(count.at(i, j, k) + met);
            }
      }
  return count;
}

/// The cell farthest from bone among those that bone encloses.
std::size_t core_of(const mask::BitMask& bone, const grid::Grid<float>& to_bone) {
  std::vector<std::uint32_t> order;
  // Space enclosed by bone lies within the bone's bounds. Without this limit the air around a head in a wide field of
  // view would be examined first.
  const grid::Box box = bone.bounds();
  for (int k = box.begin[2]; k < box.end[2]; ++k)
    for (int j = box.begin[1]; j < box.end[1]; ++j)
      for (int i = box.begin[0]; i < box.end[0]; ++i)
        if (to_bone.at(i, j, k) >= min_core_mm) order.push_back(std::uint32_t(to_bone.index(i, j, k)));
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return to_bone.voxels[a] > to_bone.voxels[b]; });
  const grid::Mask met = rays_met(bone, box);
  for (std::uint32_t v : order) {
    const int nx = bone.lattice().size[0], ny = bone.lattice().size[1];
    if (met.at(int(v % nx) - box.begin[0], int(v / nx % ny) - box.begin[1], int(v / nx / ny) - box.begin[2]) >=
        26 * min_enclosure)
      return v;
  }
  throw refusal(
      "cranial cavity", "no space of 15 mm radius that bone encloses: 0 voxels",
      {"take a series that holds the whole head, lower `lower_hu` of the bone's `segment`, or paint the brain "
       "and bring it back by the stage `labels`; of a neck or a jaw configs/ct_chest_bone.yaml makes skin and bone"});
}

grid::Mask seeds_of(const mask::BitMask& bone, const grid::Grid<float>& to_bone) {
  const grid::Lattice& l = bone.lattice();
  grid::Mask seeds(l);
  seeds.voxels[core_of(bone, to_bone)] = 1;
  // The outside is what touches the volume's sides; above and below, the scan may cut the head.
  const int vertical = vertical_axis(l);
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i) {
        const int at[3] = {i, j, k};
        for (int a = 0; a < 3; ++a)
          if (a != vertical && (at[a] == 0 || at[a] == l.size[a] - 1)) seeds.at(i, j, k) = 2;
      }
  return seeds;
}

/// Smooth across the border of the regions with that label, and above 0.5 inside them.
grid::Grid<float> share_of(const grid::Mask& labels, std::uint8_t label, double sigma_mm) {
  grid::Grid<float> share(labels);
  for (std::size_t v = 0; v < share.count(); ++v) share.voxels[v] = labels.voxels[v] == label;
  mask::gaussian(share, sigma_mm);
  return share;
}

}  // namespace

int vertical_axis(const grid::Lattice& l) {
  int vertical = 0;
  for (int a = 1; a < 3; ++a)
    if (std::abs(l.direction.column[a].z) > std::abs(l.direction.column[vertical].z)) vertical = a;
  return vertical;
}

mask::BitMask bone_of(const mask::HuView& hu) {
  const mask::Components pieces = mask::components(mask::above(hu, 226), true);
  std::vector<char> keep = mask::touching(pieces, mask::above(hu, 400));
  for (std::size_t c = 0; c < keep.size(); ++c)
    if (pieces.list[c].voxels * hu.lattice().voxel_volume_mm3() < 1000) keep[c] = 0;
  return mask::select(pieces, keep);
}

Outcome<mask::BitMask, CavityResult> cranial_cavity(const mask::BitMask& bone, const Progress& progress) {
  const mask::CoarseRaster c = mask::coarse_raster(bone.lattice(), coarse_mm);
  const mask::BitMask walls = mask::coarse_mask(bone, c, 0);
  const grid::Grid<float> to_bone = mask::distance_mm(walls, progress);
  mask::BitMask space = walls;
  space.invert();
  grid::Mask labels = mask::flood(to_bone, space, seeds_of(walls, to_bone), progress);
  // The spinal canal is what lies farther than a corner from where a ball of canal_mm fits.
  mask::BitMask wide = mask::make_mask(c.cells, [&](int j, int k, std::uint8_t* row) {
    for (int i = 0; i < c.cells.size[0]; ++i) row[i] = labels.at(i, j, k) == 1 && to_bone.at(i, j, k) >= canal_mm;
  });
  wide = mask::dilated(mask::largest(mask::components(wide)), canal_mm + corner_mm, progress);
  for (int k = 0; k < c.cells.size[2]; ++k)
    for (int j = 0; j < c.cells.size[1]; ++j)
      for (int i = 0; i < c.cells.size[0]; ++i)
        if (labels.at(i, j, k) == 1 && !wide.get(i, j, k)) labels.at(i, j, k) = 2;
  // Bone cells go to the nearer side, so that the border of the regions runs inside the bone.
  grid::Grid<float> into_bone = mask::distance_mm(space, progress);
  for (float& d : into_bone.voxels) d = std::max(0.f, 1000.f - d);
  mask::BitMask all(c.cells);
  all.invert();
  labels = mask::flood(into_bone, all, labels, progress);

  mask::BitMask cavity = mask::above_half(share_of(labels, 1, 1.5), c, bone.lattice());
  cavity.remove(bone);
  // A space that is only connected by a pore in the bone (a sinus) does not belong to the cavity.
  mask::BitMask core = mask::largest(mask::components(mask::eroded(cavity, opening_mm, progress)));
  core = mask::dilated(core, 2 * opening_mm, progress);
  cavity &= core;
  const double ml = double(cavity.count()) * bone.lattice().voxel_volume_mm3() / 1000;
  Warnings warnings;
  if (ml < 700 || ml > 2200)
    warnings.push_back(
        {"unusual_cranial_cavity", "the cranial cavity found is not of the size of a whole adult one", {}});
  return {std::move(cavity), {ml}, std::move(warnings)};
}

}  // namespace trephine::place
