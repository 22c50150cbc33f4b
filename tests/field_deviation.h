// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// How far a field's surface is off the truth.
#include <algorithm>
#include <cmath>

#include "grid/grid.h"

namespace trephine {

/// Calls f(world position) for each crossing of the field along its lattice's edges.
template <class F>
void for_crossings(const grid::Field& field, F&& f) {
  for (int k = 0; k < field.size[2]; ++k)
    for (int j = 0; j < field.size[1]; ++j)
      for (int i = 0; i < field.size[0]; ++i)
        for (int a = 0; a < 3; ++a) {
          const int n[3] = {i + (a == 0), j + (a == 1), k + (a == 2)};
          if (!field.contains(n[0], n[1], n[2])) continue;
          const double u = field.at(i, j, k), v = field.at(n[0], n[1], n[2]);
          if ((u > 0) == (v > 0)) continue;
          Vec3 p{double(i), double(j), double(k)};
          p[a] += u / (u - v);
          f(field.to_world_mm(p));
        }
}

struct FieldDeviation {
  double mean = 0, rms = 0, max = 0;
  int count = 0;
};

/// Of distance(world) at the crossings.
template <class Distance>
FieldDeviation field_deviation(const grid::Field& field, Distance&& distance) {
  FieldDeviation d;
  for_crossings(field, [&](Vec3 p) {
    const double e = distance(p);
    d.mean += e;
    d.rms += e * e;
    d.max = std::max(d.max, std::abs(e));
    ++d.count;
  });
  d.mean /= d.count;
  d.rms = std::sqrt(d.rms / d.count);
  return d;
}

}  // namespace trephine
