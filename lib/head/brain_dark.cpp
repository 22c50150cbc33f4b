// SPDX-License-Identifier: GPL-3.0-or-later
#include "head/brain_dark.h"

#include "mask/filters.h"

namespace trephine::head {
namespace {

constexpr float csf_hu = 13;          ///< what is darker is CSF: oedema has 15 to 25
constexpr float sheet_hu = 6;         ///< by this a sulcus is darker than the mean about it
constexpr float lesion_hu = 25;       ///< and of a lesion that mean is darker than this
constexpr double about_mm = 5;        ///< sigma of that mean: wider than a sulcus, narrower than a lesion
constexpr double border_mm = 2.5;     ///< so far about CSF lies what is mixed with it
constexpr float not_seen_hu = -1000;  ///< beside bone

}  // namespace

mask::BitMask dark_tissue(const mask::BitMask& cut, const mask::BitMask& shape, const grid::Grid<float>& soft,
                          const Progress& progress) {
  mask::BitMask seen = mask::make_mask(soft, [&](int j, int k, std::uint8_t* row) {
    for (int i = 0; i < soft.size[0]; ++i) row[i] = soft.at(i, j, k) > not_seen_hu;
  });
  seen &= shape;
  const grid::Grid<float> mean = mask::masked_gaussian(soft, seen, about_mm, not_seen_hu, 0.02, progress);
  mask::BitMask csf = mask::make_mask(soft, [&](int j, int k, std::uint8_t* row) {
    for (int i = 0; i < soft.size[0]; ++i) {
      const float hu = soft.at(i, j, k), about = mean.at(i, j, k);
      row[i] = hu < csf_hu || hu < about - sheet_hu || about > lesion_hu;
    }
  });
  csf &= cut;
  mask::BitMask tissue = cut;
  return tissue.remove(mask::grown_within(csf, cut, border_mm, progress));
}

}  // namespace trephine::head
