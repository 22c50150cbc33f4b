// SPDX-License-Identifier: GPL-3.0-or-later
#include "mask/coarse_share.h"

#include <algorithm>
#include <vector>

namespace trephine::mask {

BitMask above_half(const grid::Grid<float>& share, const CoarseRaster& c, const grid::Lattice& lattice) {
  struct Axis {
    std::vector<int> low;
    std::vector<float> part;
  } axes[3];
  for (int a = 0; a < 3; ++a)
    for (int i = 0; i < lattice.size[a]; ++i) {
      const int last = share.size[a] - 1;
      const double x = std::clamp((i - (c.factor[a] - 1) / 2.0) / c.factor[a], 0.0, double(last));
      const int low = std::min(int(x), std::max(0, last - 1));
      axes[a].low.push_back(low);
      axes[a].part.push_back(last ? float(x - low) : 0.f);
    }
  return make_mask(lattice, [&](int j, int k, std::uint8_t* row) {
    const int y = axes[1].low[j], z = axes[2].low[k];
    const float v = axes[1].part[j], w = axes[2].part[k];
    const int y1 = std::min(y + 1, share.size[1] - 1), z1 = std::min(z + 1, share.size[2] - 1);
    std::vector<float> line(share.size[0]);
    for (int x = 0; x < share.size[0]; ++x)
      line[x] = (1 - w) * ((1 - v) * share.at(x, y, z) + v * share.at(x, y1, z)) +
                w * ((1 - v) * share.at(x, y, z1) + v * share.at(x, y1, z1));
    for (int i = 0; i < lattice.size[0]; ++i) {
      const int x = axes[0].low[i], x1 = std::min(x + 1, share.size[0] - 1);
      row[i] = line[x] + axes[0].part[i] * (line[x1] - line[x]) > 0.5f;
    }
  });
}

}  // namespace trephine::mask
