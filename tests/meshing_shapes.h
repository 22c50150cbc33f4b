// SPDX-License-Identifier: GPL-3.0-or-later
// Fields whose surface is known, and random ones.
#pragma once
#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <variant>

#include "grid/grid.h"
#include "meshing/contour.h"
#include "random.h"
#include "report_of.h"
#include "sampled_grid.h"

namespace trephine::shapes {

/// What a step made, and what it says of it.
struct Result {
  surface::TriMesh mesh;
  Report report;
  double number(const char* name) const { return std::get<double>(*report.find(name)); }
  std::int64_t count(const char* name) const { return std::get<std::int64_t>(*report.find(name)); }
  std::string text(const char* name) const { return std::get<std::string>(*report.find(name)); }
};

inline grid::Lattice lattice(int nx, int ny, int nz, Vec3 spacing = {1, 1, 1}, Vec3 origin = {}) {
  grid::Lattice l;
  l.size = {nx, ny, nz};
  l.spacing_mm = spacing;
  l.origin_mm = origin;
  return l;
}

inline grid::Field sample(const grid::Lattice& l, const std::function<double(Vec3)>& f) { return sampled(l, f); }

/// Signed distance to a sphere, positive inside, on a cube of n voxels around it.
inline grid::Field sphere(int n, double radius, Vec3 centre = {}, double scale = 1) {
  const double side = 2.4 * radius / n;
  grid::Lattice l = lattice(n, n, n, {side, side, side});
  l.origin_mm = centre - Vec3{1, 1, 1} * (side * (n - 1) / 2);
  return sample(l, [&](Vec3 p) { return (radius - norm(p - centre)) / scale; });
}

/// A binary field: `fill` of the voxels inside.
inline grid::Field noise(int n, std::uint64_t seed, double fill, bool binary) {
  Random random(seed);
  grid::Field f(lattice(n, n, n));
  for (float& v : f.voxels) {
    const double u = random();
    v = static_cast<float>(binary ? (u < fill ? 0.5 : -0.5) : fill - u);
  }
  return f;
}

/// Every piece of the field's surface, cavities too.
inline surface::TriMesh contoured(const grid::Field& f) {
  meshing::ContourParams p;
  p.min_component_mm3 = 0;
  p.keep_cavities = true;
  Report r;
  return value_of(r, meshing::contour(f, p));
}

}  // namespace trephine::shapes
