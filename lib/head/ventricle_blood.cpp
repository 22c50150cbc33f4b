// SPDX-License-Identifier: GPL-3.0-or-later
#include "head/ventricle_blood.h"

#include <algorithm>

#include "head/soft_tissue.h"
#include "mask/filters.h"

namespace trephine::head {
namespace {

constexpr float blood_from_hu = 46, blood_to_hu = 110;
constexpr double core_mm = 1.5, min_ml = 0.5, min_in_place = 0.5;
constexpr double at_place_mm = 4, at_horn_mm = 9;  ///< from the template's, which are of one size
constexpr double beside_fluid_mm = 2.5;            ///< blood settles under CSF
constexpr double edge_mm = 2.5;                    ///< so far the blur of its edge reaches
constexpr float fluid_hu = 8;

double ventricles_mm(Vec3 t) {
  using place::Place;
  return std::min({place::place_mm(Place::lateral_left, t), place::place_mm(Place::lateral_right, t),
                   place::place_mm(Place::third, t)});
}

mask::BitMask blood_of(const grid::Grid<float>& soft, const BloodPlace& where, const place::HeadPlace& place,
                       const Progress& progress) {
  const grid::Lattice& l = soft;
  mask::BitMask dense = mask::make_mask(soft, [&](int j, int k, std::uint8_t* row) {
    for (int i = 0; i < l.size[0]; ++i) row[i] = soft.at(i, j, k) > blood_from_hu && soft.at(i, j, k) < blood_to_hu;
  });
  dense &= where.envelope;
  dense = mask::both(mask::dilated(mask::eroded(dense, core_mm, progress), core_mm + 0.5, progress), dense);
  const mask::Components pieces = mask::components(dense);
  const std::vector<char> settled = mask::touching(pieces, mask::dilated(where.wide, beside_fluid_mm, progress));
  std::vector<double> in_place(pieces.list.size(), 0);
  mask::for_each_voxel(pieces, [&](int c, int i, int j, int k) {
    const Vec3 t = place.to_template(l.to_world_mm({double(i), double(j), double(k)}));
    in_place[std::size_t(c)] +=
        ventricles_mm(t) < at_place_mm || (settled[std::size_t(c)] && place::horns_mm(t) < at_horn_mm);
  });
  std::vector<char> keep;
  for (std::size_t c = 0; c < pieces.list.size(); ++c) {
    const double voxels = double(pieces.list[c].voxels);
    keep.push_back(voxels * l.voxel_volume_mm3() / 1000 >= min_ml && in_place[c] >= min_in_place * voxels);
  }
  return mask::select(pieces, keep);
}

}  // namespace

double show_blood_as_fluid(grid::Grid<float>& hu, const grid::Grid<float>& soft, const BloodPlace& where,
                           const place::HeadPlace& place, const Progress& progress) {
  const mask::BitMask blood = place.sure ? blood_of(soft, where, place, progress) : mask::BitMask(soft);
  if (!blood.any()) return 0;
  mask::BitMask fluid = mask::make_mask(soft, [&](int j, int k, std::uint8_t* row) {
    for (int i = 0; i < soft.size[0]; ++i)
      row[i] = soft.at(i, j, k) > where.csf_from_hu && soft.at(i, j, k) < where.csf_to_hu;
  });
  fluid &= where.known;
  std::vector<float> inside;
  mask::for_each_voxel(mask::components(mask::eroded(blood, 1, progress)),
                       [&](int, int i, int j, int k) { inside.push_back(hu.at(i, j, k)); });
  const float tissue = float(tissue_level_hu), blood_hu = mask::median(inside, blood_from_hu);
  const float ratio = (tissue - fluid_hu) / std::max(blood_hu - tissue, 1.f);
  const mask::BitMask about = mask::dilated(blood, edge_mm, progress);
  // Between blood and CSF lie all values from one to the other, those of tissue too; closed, lest the wall is taken.
  mask::BitMask between = mask::both(about, mask::dilated(fluid, edge_mm, progress));
  between &= mask::closed(fluid |= blood, edge_mm, progress);
  mask::for_each_voxel(mask::components(about), [&](int, int i, int j, int k) {
    float& v = hu.at(i, j, k);
    if (v > tissue) v = tissue - (v - tissue) * ratio;
    if (between.get(i, j, k)) v = std::min(v, fluid_hu);
  });
  return double(blood.count()) * hu.voxel_volume_mm3() / 1000;
}

}  // namespace trephine::head
