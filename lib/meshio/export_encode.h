// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Inside of meshio: what the writers of the formats have in common.
#include <array>
#include <string>
#include <vector>

#include "meshio/export_format.h"
#include "meshio/texture.h"

namespace trephine::meshio {

constexpr double float32_epsilon = 1.2e-7;

/// A surface as a format holds it.
struct PreparedSurface {
  const ExportSurface* source = nullptr;
  std::vector<Vec3> world_mm;  ///< rounded to the precision
  std::vector<Vec3> normals;   ///< one a point
  TextureMap texture;          ///< empty where none is asked for or the format has none
  const surface::TriMesh& mesh() const { return *source->mesh; }
  bool textured() const { return !texture.triangles.empty(); }
};

/// The mesh's points as the format's numbers hold them; a zero is +0.
std::vector<Vec3> rounded_world(const surface::TriMesh& mesh, Precision precision);

/// The same with one vertex a texture point, for formats that know no second index; without texture a plain copy.
struct PlainSurface {
  std::vector<Vec3> world_mm, normals;
  std::vector<std::array<double, 2>> texture;  ///< empty, or one a point
  std::vector<std::array<std::uint32_t, 3>> triangles;
};
PlainSurface plain_surface(const PreparedSurface& s);

std::array<unsigned char, 3> colour_bytes(const std::array<double, 3>& rgb);

}  // namespace trephine::meshio
