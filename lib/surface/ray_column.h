// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Parallel rays through a surface, and the spans inside it along each.
#include <array>
#include <cstdint>
#include <vector>

#include "surface/trimesh.h"

namespace trephine::surface::detail {

/// A span of a ray inside the surface, in mm along the axis.
struct Span {
  double enter = 0, leave = 0;
};

/// The part of a closed surface oriented outwards within `radius_mm` of an axis, for rays parallel to the axis. Each
/// edge decides once for both its triangles on which side a ray passes, so that no ray slips between triangles.
class RayColumn {
 public:
  /// Only the near part of the mesh is copied; `axis` has unit length.
  RayColumn(const TriMesh& mesh, Vec3 at_mm, Vec3 axis, double radius_mm);

  /// The spans of the ray through at + u * across + v * upwards, ascending and disjoint; gaps of at most `merge_mm` are
  /// closed.
  std::vector<Span> spans(double u, double v, double merge_mm) const;
  Vec3 across() const { return across_; }
  Vec3 upwards() const { return upwards_; }

 private:
  Vec3 across_, upwards_;
  int cell(double x) const;

  double radius_mm_;
  std::vector<Vec3> points_;  ///< u, v, along the axis
  std::vector<std::array<std::uint32_t, 3>> triangles_;
  std::vector<std::vector<std::uint32_t>> cells_;  ///< of a square raster over the column: the triangles that reach in
};

/// Points that fill the unit disc evenly (the golden angle), then points on its rim.
std::vector<std::array<double, 2>> disc_samples(int inside, int on_rim);

}  // namespace trephine::surface::detail
