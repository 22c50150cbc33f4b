// SPDX-License-Identifier: GPL-3.0-or-later
#include "head/brain_pits.h"

#include <algorithm>
#include <cmath>

#include "head/soft_tissue.h"
#include "mask/filters.h"

namespace trephine::head {
namespace {

constexpr double skin_mm = 1.1;     ///< what lies less deep is no pit
constexpr double min_evidence = 9;  ///< standard deviations of a mean over the piece; noise that was sought out has 3-7
constexpr double fine_mm = 1.0, wide_mm = 3.0, local_mm = 7;
constexpr double max_local = 4;  ///< how much stronger noise may be in a place
constexpr float tissue_from_hu = 18, tissue_to_hu = 45;

/// How much stronger the noise is about each voxel than in the middle of the brain's tissue; 1 or more.
grid::Grid<float> local_noise(const grid::Grid<float>& hu, const mask::BitMask& known, const mask::BitMask& shape,
                              const Progress& progress) {
  grid::Grid<float> fine = mask::masked_gaussian(hu, known, fine_mm, -1000, 0.02, progress);
  const grid::Grid<float> wide = mask::masked_gaussian(hu, known, wide_mm, -1000, 0.02, progress);
  mask::BitMask tissue = shape;
  tissue &= known;
  tissue &= mask::make_mask(hu, [&](int j, int k, std::uint8_t* row) {
    for (int i = 0; i < hu.size[0]; ++i) row[i] = wide.at(i, j, k) > tissue_from_hu && wide.at(i, j, k) < tissue_to_hu;
  });
  std::vector<float> all;
  for (int k = 0; k < hu.size[2]; ++k)
    for (int j = 0; j < hu.size[1]; ++j)
      for (int i = 0; i < hu.size[0]; ++i) {
        float& f = fine.at(i, j, k);
        f = std::abs(f - wide.at(i, j, k));
        if (tissue.get(i, j, k) && (i + j + k) % 3 == 0) all.push_back(f);
      }
  // Sulci spread values too; more than half of the brain has none within reach.
  const float usual = std::max(0.2f, mask::median(all, 1.f));
  grid::Grid<float> local = mask::masked_gaussian(std::move(fine), tissue, local_mm, usual, 0.02, progress);
  for (float& f : local.voxels) f = std::clamp(f / usual, 1.f, float(max_local));
  return local;
}

}  // namespace

mask::BitMask noise_pits(const mask::BitMask& cut, const mask::BitMask& shape, const grid::Grid<float>& hu,
                         const mask::BitMask& known, double noise, const Progress& progress) {
  mask::BitMask deep = cut;
  deep &= mask::eroded(shape, skin_mm, progress);
  const mask::Components pieces = mask::components(deep);
  const grid::Grid<float> local = local_noise(hu, known, shape, progress);
  struct Sum {
    double dark = 0, voxels = 0, noise = 0;
  };
  std::vector<Sum> sums(pieces.list.size());
  const grid::Lattice& l = deep.lattice();
  mask::for_each_voxel(pieces, [&](int component, int i, int j, int k) {
    if (!known.get(i, j, k)) return;
    Sum& s = sums[std::size_t(component)];
    s.dark += tissue_level_hu - hu.at(i, j, k);
    s.noise += local.at(i, j, k);
    s.voxels += 1;
  });
  std::vector<char> pit;
  for (const Sum& s : sums) {
    if (!(s.voxels > 0)) {  // beside bone, where HU are not reliable: no evidence
      pit.push_back(1);
      continue;
    }
    const double mm3 = s.voxels * l.voxel_volume_mm3(), spread = noise * (s.noise / s.voxels) / std::sqrt(mm3);
    pit.push_back(s.dark / s.voxels < min_evidence * spread);
  }
  return mask::select(pieces, pit);
}

}  // namespace trephine::head
