// SPDX-License-Identifier: GPL-3.0-or-later
#include "head/brain_pits.h"

#include <algorithm>
#include <cmath>

#include "base/pi.h"
#include "head/soft_tissue.h"
#include "mask/along_sheets.h"
#include "mask/filters.h"

namespace trephine::head {
namespace {

constexpr double skin_mm = 1.1;  ///< what lies less deep is no pit
/// Means along edges and sulci are taken so wide that their noise falls to mean_noise_hu. Where they are darker than
/// tissue by shown_evidence standard deviations, and all that is so in a place by more, a sulcus is shown, and as far
/// as reach_mm from there.
constexpr double mean_noise_hu = 2, min_mean_mm = 0.4, max_mean_mm = 4, across_mm = 1.2;
constexpr double shown_evidence = 3, shown_piece_evidence = 4.5, reach_mm = 2;
constexpr double piece_evidence = 9;  ///< of the mean over a whole piece; noise that was sought out has 3 to 7
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

/// The pieces that are darker than tissue, summed over the piece, by so many standard deviations of noise.
mask::BitMask evident(const mask::BitMask& some, const grid::Grid<float>& hu, const mask::BitMask& known,
                      const grid::Grid<float>& local, double noise, double deviations) {
  const mask::Components pieces = mask::components(some);
  struct Sum {
    double dark = 0, voxels = 0, noise = 0;
  };
  std::vector<Sum> sums(pieces.list.size());
  mask::for_each_voxel(pieces, [&](int piece, int i, int j, int k) {
    if (!known.get(i, j, k)) return;  // beside bone, where HU are not reliable: no evidence
    Sum& s = sums[std::size_t(piece)];
    s.dark += tissue_level_hu - hu.at(i, j, k);
    s.noise += local.at(i, j, k);
    s.voxels += 1;
  });
  const double voxel_noise = noise / std::sqrt(hu.voxel_volume_mm3());
  std::vector<char> keep;
  for (const Sum& s : sums)
    keep.push_back(s.voxels > 0 && s.dark >= deviations * voxel_noise * (s.noise / s.voxels) * std::sqrt(s.voxels));
  return mask::select(pieces, keep);
}

}  // namespace

mask::BitMask noise_pits(const mask::BitMask& cut, const mask::BitMask& shape, const grid::Grid<float>& hu,
                         const mask::BitMask& known, double noise, const Progress& progress) {
  mask::BitMask deep = cut;
  deep &= mask::eroded(shape, skin_mm, progress);
  // 4 pi sigma^2 of the plane, and about a millimetre across it.
  const double mean_mm = std::clamp(noise / mean_noise_hu / std::sqrt(4 * pi * across_mm), min_mean_mm, max_mean_mm),
               mean_noise = noise / std::sqrt(4 * pi * across_mm) / mean_mm;
  const grid::Grid<float> mean = mask::averaged_along_sheets(hu, known, mean_mm, progress, &deep),
                          local = local_noise(hu, known, shape, progress);
  mask::BitMask shown = mask::make_mask(hu, [&](int j, int k, std::uint8_t* row) {
    for (int i = 0; i < hu.size[0]; ++i)
      row[i] = tissue_level_hu - mean.at(i, j, k) > shown_evidence * mean_noise * double(local.at(i, j, k));
  });
  (shown &= deep) &= known;
  const mask::BitMask sulci =
      mask::grown_within(evident(shown, hu, known, local, noise, shown_piece_evidence), deep, reach_mm, progress);
  // What is not shown anywhere near may be shown by the whole of a piece.
  mask::BitMask rest = mask::without(std::move(deep), sulci);
  return mask::without(rest, evident(rest, hu, known, local, noise, piece_evidence));
}

}  // namespace trephine::head
