// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "surface/trimesh.h"

namespace trephine::meshio {

/// A mesh's texture: points of it that carry texture coordinates (a mesh's point once for each u that it needs), and
/// the triangles, in the mesh's order, as indices into them.
struct TexturePoint {
  std::uint32_t point = 0;  ///< of the mesh
  double u = 0, v = 0;
};
struct TextureMap {
  std::vector<TexturePoint> points;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Spherical coordinates about the surface's (area) centroid and the z axis: u is the azimuth / 2 pi, 0.5 in front (-y)
/// and growing to the patient's left, with the seam behind (+y); v the elevation / pi, 0 below and 1 above. A triangle
/// across the seam has u from below 1 to above 1 (the texture repeats), so no triangle runs backwards through the
/// picture. A corner on the axis has no azimuth and takes the mean u of the triangle's others; a triangle around the
/// axis is cut at its widest gap, so that it spans less than 1. Rounded to 1e-6. The mesh is not touched; its indices
/// must be in range, its points finite.
TextureMap spherical_texture(const surface::TriMesh& mesh);

}  // namespace trephine::meshio
