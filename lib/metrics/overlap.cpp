// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/overlap.h"

#include <algorithm>

namespace trephine::metrics {
grid::Mask select_label(const grid::Mask& labels, int label) {
  grid::Mask m(static_cast<const grid::Lattice&>(labels));
  for (std::size_t i = 0; i < m.voxels.size(); ++i)
    m.voxels[i] = label == 0 ? labels.voxels[i] != 0 : labels.voxels[i] == label;
  return m;
}

double volume_mm3(const grid::Mask& mask) {
  const auto n = mask.voxels.size() - std::size_t(std::count(mask.voxels.begin(), mask.voxels.end(), 0));
  return double(n) * mask.voxel_volume_mm3();
}

double dice(const grid::Mask& a, const grid::Mask& b) {
  const grid::Box box = grid::place_in(b, a);
  const auto count = [](const grid::Mask& m) {
    return m.voxels.size() - std::size_t(std::count(m.voxels.begin(), m.voxels.end(), 0));
  };
  const std::size_t sum = count(a) + count(b);
  if (sum == 0) return 1;
  std::size_t common = 0;
  for (int k = std::max(0, box.begin[2]); k < std::min(a.size[2], box.end[2]); ++k)
    for (int j = std::max(0, box.begin[1]); j < std::min(a.size[1], box.end[1]); ++j)
      for (int i = std::max(0, box.begin[0]); i < std::min(a.size[0], box.end[0]); ++i)
        common += a.at(i, j, k) != 0 && b.at(i - box.begin[0], j - box.begin[1], k - box.begin[2]) != 0;
  return 2 * double(common) / double(sum);
}

}  // namespace trephine::metrics
