// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <filesystem>
#include <string>
#include <string_view>

#include "surface/trimesh.h"

namespace trephine {

/// One surface as binary glTF 2.0 (registry.khronos.org/glTF/specs/2.0): what the simulator, a browser and a game
/// engine load alike. One mesh of one primitive, indexed, one vertex a position, smooth normals, float32 millimetres in
/// LPS about the case's centre. Its one node holds the matrix to glTF's metres, Y up, +Z forward, proper (determinant
/// 1e-9):
///   x_gltf = 0.001 x (patient's left),  y_gltf = 0.001 z (superior),  z_gltf = -0.001 y (anterior: the face looks at
///   +Z)
/// and says in its `extras`: frame "LPS", unit "mm", center_mm.
struct GlbParams {
  Vec3 center_mm;                                   ///< LPS; vertex = position - center_mm
  std::string name;                                 ///< of mesh, node and material
  std::array<double, 3> colour_rgb{0.8, 0.8, 0.8};  ///< sRGB, 0 to 1; converted to the linear base colour of glTF
  double opacity = 1;                               ///< below 1 the material blends
};

/// The same bytes for the same mesh. Normals are the mesh's, or angle-weighted ones where it has none; indices are
/// uint16 where they fit. What was made is read back and compared (bounds, counts, positions and indices) before it is
/// returned. Throws Error 65 where the mesh is damaged (check_mesh), 80 where it is empty, or rounding to float32 makes
/// two corners of a triangle one.
std::string make_glb(const TriMesh& mesh, const GlbParams& params);

struct GlbMesh {
  TriMesh mesh;  ///< origin_mm is the centre; with normals
  std::string name;
  std::array<double, 3> colour_rgb{0.8, 0.8, 0.8};
  double opacity = 1;
};

/// The simulator's reader: strict. It takes only what make_glb writes, in whatever order of keys, chunks bounded, every
/// count, offset and index checked before use, numbers finite, no external file. Throws Error 65 naming the field. The
/// caller has checked the checksum; this holds without it too.
GlbMesh read_glb(std::string_view bytes);
/// Throws 66 where there is no file.
GlbMesh read_glb_file(const std::filesystem::path& file);

}  // namespace trephine
