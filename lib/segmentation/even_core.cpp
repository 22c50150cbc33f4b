// SPDX-License-Identifier: GPL-3.0-or-later
#include "segmentation/even_core.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/rank.h"
#include "mask/filters.h"

namespace trephine::segmentation {
namespace {

constexpr double depth_mm = 2.5, box_mm = 3.5;
constexpr double even_ratio = 1.6, max_blood_hu = 480;
constexpr double least_noise_hu = 1;  ///< less is no scanner's
constexpr int sample_step = 4, least_samples = 200;

struct Spread {
  double mean = 0, sd = 0;
};

class Box {
 public:
  explicit Box(const mask::HuView& hu) : hu_(hu) {
    for (int a = 0; a < 3; ++a) half_[a] = int(std::lround(box_mm / hu.lattice().spacing_mm[a])) / 2;
  }
  bool fits(int i, int j, int k) const {
    const auto& n = hu_.lattice().size;
    return i >= half_[0] && j >= half_[1] && k >= half_[2] && i < n[0] - half_[0] && j < n[1] - half_[1] &&
           k < n[2] - half_[2];
  }
  Spread at(int i, int j, int k) const {
    double sum = 0, squares = 0;
    int n = 0;
    for (int z = k - half_[2]; z <= k + half_[2]; ++z)
      for (int y = j - half_[1]; y <= j + half_[1]; ++y)
        for (int x = i - half_[0]; x <= i + half_[0]; ++x) {
          const double v = hu_(x, y, z);
          sum += v, squares += v * v, ++n;
        }
    const double mean = sum / n;
    return {mean, std::sqrt(std::max(0.0, squares / n - mean * mean))};
  }

 private:
  const mask::HuView& hu_;
  std::array<int, 3> half_{};
};

/// Of the boxes about soft tissue a quarter is evener than this: those at an edge are not.
double noise_of(const mask::HuView& hu, const Box& box) {
  const auto& n = hu.lattice().size;
  std::vector<double> all;
  for (int k = 0; k < n[2]; k += sample_step / 2)
    for (int j = 0; j < n[1]; j += sample_step)
      for (int i = 0; i < n[0]; i += sample_step) {
        if (!box.fits(i, j, k)) continue;
        if (const float v = hu(i, j, k); !(v > -100 && v < 200)) continue;
        const Spread s = box.at(i, j, k);
        if (s.mean > 0 && s.mean < 100) all.push_back(s.sd);
      }
  return all.size() < least_samples ? 0 : value_at_rank(all, all.size() / 4);
}

}  // namespace

std::optional<EvenCore> even_core(const mask::BitMask& shape, const mask::HuView& hu, std::array<int, 3> begin,
                                  const Progress& progress) {
  const Box box(hu);
  const double noise = noise_of(hu, box);
  if (noise < least_noise_hu) return std::nullopt;
  const mask::BitMask core = mask::eroded(shape, depth_mm, progress);
  const grid::Lattice& l = core.lattice();
  const mask::BitMask even = mask::make_mask(l, [&](int j, int k, std::uint8_t* row) {
    for (int i = 0; i < l.size[0]; ++i) {
      row[i] = 0;
      const int x = i + begin[0], y = j + begin[1], z = k + begin[2];
      if (!core.get(i, j, k) || hu(x, y, z) > 2 * max_blood_hu || !box.fits(x, y, z)) continue;
      const Spread s = box.at(x, y, z);
      row[i] = s.sd < even_ratio * noise && s.mean < max_blood_hu;
    }
  });
  const mask::BitMask piece = mask::largest(mask::components(even));
  const std::size_t n = piece.count();
  if (n == 0) return EvenCore{};
  double sum_hu = 0;
  const grid::Box box_of_piece = piece.bounds();
  for (int k = box_of_piece.begin[2]; k < box_of_piece.end[2]; ++k)
    for (int j = box_of_piece.begin[1]; j < box_of_piece.end[1]; ++j)
      for (int i = box_of_piece.begin[0]; i < box_of_piece.end[0]; ++i)
        if (piece.get(i, j, k)) sum_hu += hu(i + begin[0], j + begin[1], k + begin[2]);
  return EvenCore{double(n) * l.voxel_volume_mm3() / 1000, sum_hu / double(n), piece.centre_mm()};
}

}  // namespace trephine::segmentation
