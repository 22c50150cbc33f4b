// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Inside of meshio: what other programs' readers make of a file, read in a bounded child.
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/child.h"
#include "base/progress.h"
#include "base/vec3.h"
#include "meshio/foreign_reader.h"

namespace trephine::meshio {

/// One mesh of a file as its reader gave it: finite points in the file's own coordinates (nodes' transforms applied),
/// triangles with indices in range, polygons triangulated. Points may be repeated.
struct ForeignSurface {
  std::string name;
  bool has_colour = false, has_opacity = false;
  std::array<double, 3> colour{0, 0, 0};  ///< as in the file: linear in glTF
  double opacity = 1;
  std::uint64_t texture_points = 0;
  std::vector<Vec3> points;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Reads the bytes. `companion` stands for any .mtl that they name (empty: there is none); nothing else is opened.
/// Throws Error 65 where the reader refuses the bytes or returns an inconsistent mesh; 70 where the child dies or
/// exceeds the limits.
std::vector<ForeignSurface> read_foreign(const ForeignReader& reader, std::string_view bytes,
                                         std::string_view companion, const ChildLimits& limits,
                                         const Progress& progress = {});

/// Limits for a file of that size.
ChildLimits foreign_limits(std::size_t bytes);

}  // namespace trephine::meshio
