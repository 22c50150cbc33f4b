// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Volumes of HU whose surfaces are known: a ball and steps, and the eyes that look at them.
#include <algorithm>
#include <cmath>
#include <functional>

#include "cast/ray_cast.h"

namespace trephine::casting {

inline grid::Lattice lattice(int n, double spacing_mm) {
  grid::Lattice l;
  l.size = {n, n + 3, n - 2};
  l.spacing_mm = {spacing_mm, spacing_mm, 1.5 * spacing_mm};
  const Vec3 z = normalized(Vec3{0.2, -0.3, 0.9});
  l.direction.column[2] = z;
  l.direction.column[0] = normalized(cross(Vec3{0.1, 1, 0.3}, z));
  l.direction.column[1] = cross(z, l.direction.column[0]);
  l.origin_mm = {-31.7, 12.3, 8.9};
  return l;
}

inline Vec3 middle_of(const grid::Lattice& l) {
  return l.to_world_mm({(l.size[0] - 1) / 2.0, (l.size[1] - 1) / 2.0, (l.size[2] - 1) / 2.0});
}

inline grid::Grid<std::int16_t> filled(const grid::Lattice& l, const std::function<double(Vec3)>& hu) {
  grid::Grid<std::int16_t> v(l);
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i)
        v.at(i, j, k) = std::int16_t(
            std::lround(std::clamp(hu(l.to_world_mm({double(i), double(j), double(k)})), -1024.0, 3071.0)));
  return v;
}

/// HU that fall linearly with the distance from its middle: 0 at the radius.
inline grid::Grid<std::int16_t> ball(const grid::Lattice& l, double radius_mm, double hu_per_mm) {
  const Vec3 middle = middle_of(l);
  return filled(l, [=](Vec3 p) { return hu_per_mm * (radius_mm - norm(p - middle)); });
}

/// Looks at the lattice's middle from there, and sees `across_mm` of it.
inline scene::EyeView eye_at(const grid::Lattice& l, Vec3 toward, double across_mm, double distance_mm = 200) {
  scene::EyeView e;
  e.toward = normalized(toward);
  e.right = normalized(cross(Vec3{0.1, 0.2, 1}, e.toward));
  e.up = cross(e.toward, e.right);
  e.eye_mm = middle_of(l) + e.toward * distance_mm;
  e.right_edge = e.top = across_mm / 2 / distance_mm;
  e.left = e.bottom = -e.top;
  e.near_mm = 10;
  e.far_mm = 600;
  return e;
}

inline voxel::TransferFunction ramp(double low_hu, double high_hu, double opacity = 1) {
  voxel::TransferFunction f;
  f.points = {{low_hu, 0, {0.9, 0.8, 0.7}}, {high_hu, opacity, {0.9, 0.8, 0.7}}};
  return f;
}

inline cast::CastPicture cast_of(const grid::Grid<std::int16_t>& v, const voxel::TransferFunction& f,
                                 const scene::EyeView& eye, int side, const cast::CastParams& params = {}) {
  const cast::CastTable table({f});
  return cast::cast_rays(v, table, cast::CastBricks(v, table), eye, side, side, params);
}

}  // namespace trephine::casting
