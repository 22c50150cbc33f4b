// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cmath>

#include "base/error.h"
#include "base/pi.h"
#include "surface/trimesh.h"

namespace trephine {

/// A closed, valid bumpy ball of about that radius with a pole above and one below, and points on the raster of 2^-14
/// mm: no symmetry that a swapped axis or a wrong sign could hide in.
inline surface::TriMesh bumpy_ball(int around, int rows, Vec3 centre_mm, double radius_mm = 80, bool normals = true) {
  surface::TriMesh m;
  m.origin_mm = centre_mm;
  const auto raster = [](double v) { return std::nearbyint(v * 16384) / 16384; };
  for (int j = 0; j <= rows; ++j)
    for (int i = 0; i < (j == 0 || j == rows ? 1 : around); ++i) {
      const double a = 2 * pi * (i + 0.3) / around, b = pi * j / rows;
      const double r = radius_mm * (1 + 0.05 * std::sin(2 * a + 0.4) * std::sin(b));
      const Vec3 n{std::sin(b) * std::cos(a), std::sin(b) * std::sin(a), std::cos(b)};
      m.points_mm.push_back({raster(1.1 * n.x * r), raster(0.9 * n.y * r), raster(n.z * r)});
      if (normals) m.normals.push_back(normalized(n));
    }
  const auto at = [&](int j, int i) -> std::uint32_t {
    return j == 0      ? 0u
           : j == rows ? std::uint32_t(1 + (rows - 1) * around)
                       : std::uint32_t(1 + (j - 1) * around + i % around);
  };
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < around; ++i) {
      if (j > 0) m.triangles.push_back({at(j, i), at(j + 1, i), at(j, i + 1)});
      if (j + 1 < rows) m.triangles.push_back({at(j, i + 1), at(j + 1, i), at(j + 1, i + 1)});
    }
  return m;
}

template <class F>
ExitCode code_of(F&& f, std::string* line = nullptr) {
  try {
    f();
  } catch (const Error& e) {
    if (line) *line = e.line("trephine");
    return e.code();
  }
  return ExitCode::ok;
}

}  // namespace trephine
