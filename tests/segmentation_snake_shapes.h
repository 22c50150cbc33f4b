// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/report.h"
#include "field_deviation.h"
#include "grid/grid.h"
#include "random.h"
#include "sampled_grid.h"

// Grids sampled from closed forms, and how far a field's surface lies from one.
namespace trephine::segmentation_test {

inline grid::Lattice lattice(Vec3 extent_mm, Vec3 spacing) {
  grid::Lattice l;
  for (int a = 0; a < 3; ++a) l.size[a] = std::max(2, int(std::lround(extent_mm[a] / spacing[a])));
  l.spacing_mm = spacing;
  for (int a = 0; a < 3; ++a) l.origin_mm[a] = -0.5 * (l.size[a] - 1) * spacing[a];
  return l;
}

/// Gaussian noise that is the same everywhere (Box and Muller).
class Noise {
 public:
  explicit Noise(std::uint64_t seed) : random_(seed) {}
  double gaussian() {
    const double r = std::sqrt(-2 * std::log(1 - random_()));
    return r * std::cos(2 * M_PI * random_());
  }

 private:
  Random random_;
};

inline std::size_t inside(const grid::Field& f) {
  return std::size_t(std::count_if(f.voxels.begin(), f.voxels.end(), [](float v) { return v > 0; }));
}

/// Dice of two fields on one raster.
inline double dice(const grid::Field& a, const grid::Field& b) {
  const grid::Field c = grid::fit(b, static_cast<const grid::Lattice&>(a), -1.f);
  std::size_t both = 0;
  for (std::size_t v = 0; v < a.count(); ++v) both += a.voxels[v] > 0 && c.voxels[v] > 0;
  return 2.0 * double(both) / double(inside(a) + inside(b));
}

template <class F>
Error error_of(F&& f) {
  try {
    f();
  } catch (const Error& e) {
    return e;
  }
  return Error(ExitCode::ok, "", "", "");
}

}  // namespace trephine::segmentation_test
