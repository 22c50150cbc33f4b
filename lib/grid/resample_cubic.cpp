// SPDX-License-Identifier: GPL-3.0-or-later
#include "grid/resample_cubic.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/parallel.h"

namespace trephine::grid {

Field resampled_cubic(Field from, const Lattice& to, const Progress& progress) {
  const Vec3 first = from.to_index(to.origin_mm);
  for (int axis = 0; axis < 3; ++axis) {
    Lattice l = from;
    l.size[axis] = to.size[axis];
    l.spacing_mm[axis] = to.spacing_mm[axis];
    Field out(l);
    struct Taps {
      int at[4];
      float weight[4];
    };
    std::vector<Taps> taps(l.size[axis]);
    for (int n = 0; n < l.size[axis]; ++n) {
      const double x = first[axis] + n * to.spacing_mm[axis] / from.spacing_mm[axis];
      const int before = int(std::floor(x)) - 1;
      const double t = x - before - 1;
      const double w[4] = {t * (-0.5 + t * (1 - 0.5 * t)), 1 + t * t * (-2.5 + 1.5 * t), t * (0.5 + t * (2 - 1.5 * t)),
                           t * t * (-0.5 + 0.5 * t)};
      for (int m = 0; m < 4; ++m) {
        taps[n].at[m] = std::clamp(before + m, 0, from.size[axis] - 1);
        taps[n].weight[m] = float(w[m]);
      }
    }
    parallel_for(0, l.size[2], 2, [&](std::int64_t begin, std::int64_t end) {
      progress.check();
      for (int k = int(begin); k < end; ++k)
        for (int j = 0; j < l.size[1]; ++j) {
          float* row = &out.at(0, j, k);
          for (int m = 0; m < 4; ++m) {
            if (axis == 0) {
              const float* in = &from.at(0, j, k);
              for (int i = 0; i < l.size[0]; ++i) row[i] += taps[i].weight[m] * in[taps[i].at[m]];
            } else {
              const Taps& t = taps[axis == 1 ? j : k];
              const float* in = axis == 1 ? &from.at(0, t.at[m], k) : &from.at(0, j, t.at[m]);
              for (int i = 0; i < l.size[0]; ++i) row[i] += t.weight[m] * in[i];
            }
          }
        }
    });
    from = std::move(out);
  }
  static_cast<Lattice&>(from) = to;
  return from;
}

}  // namespace trephine::grid
