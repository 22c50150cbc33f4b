// SPDX-License-Identifier: GPL-3.0-or-later
// Fields whose surface is known, and random ones.
#pragma once
#include <cmath>
#include <cstdint>
#include <functional>

#include "grid/grid.h"

namespace trephine::shapes {

/// SplitMix64: the same numbers everywhere.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  double operator()() {  // 0 to 1
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15ull);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return static_cast<double>((z ^ (z >> 31)) >> 11) / 9007199254740992.0;
  }

 private:
  std::uint64_t state_;
};

inline Lattice lattice(int nx, int ny, int nz, Vec3 spacing = {1, 1, 1}, Vec3 origin = {}) {
  Lattice l;
  l.size = {nx, ny, nz};
  l.spacing_mm = spacing;
  l.origin_mm = origin;
  return l;
}

inline Field sample(const Lattice& l, const std::function<double(Vec3)>& f) {
  Field field(l);
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i)
        field.at(i, j, k) = static_cast<float>(f(l.to_world_mm({double(i), double(j), double(k)})));
  return field;
}

/// Signed distance to a sphere, positive inside, on a cube of n voxels around it.
inline Field sphere(int n, double radius, Vec3 centre = {}, double scale = 1) {
  const double side = 2.4 * radius / n;
  Lattice l = lattice(n, n, n, {side, side, side});
  l.origin_mm = centre - Vec3{1, 1, 1} * (side * (n - 1) / 2);
  return sample(l, [&](Vec3 p) { return (radius - norm(p - centre)) / scale; });
}

/// A binary field: `fill` of the voxels inside.
inline Field noise(int n, std::uint64_t seed, double fill, bool binary) {
  Random random(seed);
  Field f(lattice(n, n, n));
  for (float& v : f.voxels) {
    const double u = random();
    v = static_cast<float>(binary ? (u < fill ? 0.5 : -0.5) : fill - u);
  }
  return f;
}

}  // namespace trephine::shapes
