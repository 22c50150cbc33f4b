// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <limits>
#include <memory>
#include <vector>

#include "base/progress.h"
#include "surface/trimesh.h"

namespace trephine::surface {

/// Distances from points to a surface, exact for the given triangles, however degenerate they are. The object refers to
/// the mesh, which must outlive it unchanged.
///
/// Signs: negative inside and positive outside of a closed mesh oriented outwards (angle-weighted pseudonormals
/// [Baerentzen2005]); at the border of an open mesh the sign is that of the side which the nearest triangles face.
class PointToMesh {
 public:
  /// Throws Error 65 as check_mesh does, and where the mesh has no triangles or coordinates beyond 1e15 mm.
  explicit PointToMesh(const TriMesh& mesh, const Progress& progress = {});
  ~PointToMesh();
  PointToMesh(PointToMesh&&) noexcept;
  PointToMesh& operator=(PointToMesh&&) noexcept;

  double distance_mm(Vec3 world_mm) const;
  double signed_distance_mm(Vec3 world_mm) const;
  Vec3 closest_mm(Vec3 world_mm) const;  ///< world

  /// The same for many points at once, in parallel; fastest where successive points lie near each other. Throws Error
  /// 65 for a point that is not finite.
  std::vector<double> distances_mm(const std::vector<Vec3>& world_mm, const Progress& progress = {}) const;
  std::vector<double> signed_distances_mm(const std::vector<Vec3>& world_mm, const Progress& progress = {}) const;

  /// max(at_least_mm, the largest distance of a point); much faster than distances_mm where few points exceed
  /// at_least_mm.
  double largest_distance_mm(const std::vector<Vec3>& world_mm, double at_least_mm,
                             const Progress& progress = {}) const;

 private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

}  // namespace trephine::surface
