// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Where the volume's border cuts an anatomy.
#include <vector>

#include "surface/trimesh.h"

namespace trephine::boolean::detail {

/// A plane beyond which nothing was scanned: dot(normal, world) <= offset_mm for the whole surface.
struct CutFace {
  Vec3 normal;
  double offset_mm = 0, area_mm2 = 0;
  double inside_mm(Vec3 world) const { return offset_mm - dot(normal, world); }
};

/// The flat faces with which a contour closes an anatomy at the volume's border: at least 60 mm^2 and eight triangles
/// in one plane to 0.02 mm, with the whole surface on one side of it. Bodies have no such faces of their own. The
/// border of a rectified tilted scan is not flat and is not found.
std::vector<CutFace> cut_faces(const surface::TriMesh& mesh);

}  // namespace trephine::boolean::detail
