// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <filesystem>
#include <string>
#include <string_view>

#include "surface/trimesh.h"

namespace trephine::cases {

/// One surface as binary glTF 2.0 (registry.khronos.org/glTF/specs/2.0), which the simulator, a browser and a game
/// engine can all load. It has one mesh of one indexed primitive, one vertex for each position, smooth normals, and
/// float32 millimetres in LPS relative to the case's centre. Its one node holds the matrix to glTF's metres, Y up, +Z
/// forward, which is proper (determinant 1e-9):
/// - x_gltf = 0.001 x (patient's left)
/// - y_gltf = 0.001 z (superior)
/// - z_gltf = -0.001 y (anterior: the face looks at +Z)
///
/// The node's `extras` hold frame "LPS", unit "mm" and center_mm.
struct GlbParams {
  Vec3 center_mm;                                   ///< LPS; vertex = position - center_mm
  std::string name;                                 ///< of mesh, node and material
  std::array<double, 3> colour_rgb{0.8, 0.8, 0.8};  ///< sRGB, 0 to 1; converted to the linear base colour of glTF
  double opacity = 1;                               ///< below 1 the material blends
};

/// The same mesh gives the same bytes. Normals are the mesh's, or angle-weighted ones where it has none; indices are
/// uint16 where they fit. The bytes are read back and compared (bounds, counts, positions and indices) before they are
/// returned. Throws Error 65 where the mesh is damaged (check_mesh), 80 where it is empty or where rounding to float32
/// merges two corners of a triangle.
std::string make_glb(const surface::TriMesh& mesh, const GlbParams& params);

struct GlbMesh {
  surface::TriMesh mesh;  ///< origin_mm is the centre; with normals
  std::string name;
  std::array<double, 3> colour_rgb{0.8, 0.8, 0.8};
  double opacity = 1;
};

/// The simulator's strict reader. It accepts only what make_glb writes, with keys in any order. Chunks are bounded,
/// every count, offset and index is checked before use, numbers must be finite, and external files are refused. Throws
/// Error 65 naming the field. The caller has checked the checksum, but the reader is safe without it.
GlbMesh read_glb(std::string_view bytes);
/// Throws Error 66 where there is no file.
GlbMesh read_glb_file(const std::filesystem::path& file);

}  // namespace trephine::cases
