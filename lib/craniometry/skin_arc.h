// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Rays and lengths over the surface of a field, without making a mesh of it.
#include <optional>
#include <vector>

#include "grid/grid.h"
#include "surface/arc.h"

namespace trephine::craniometry {

/// A field in world mm: trilinear between voxels, -1 outside its lattice. Keeps references to both arguments.
class FieldView {
 public:
  /// `volume` is the scan of which the field covers a part.
  FieldView(const grid::Field& field, const grid::Lattice& volume);
  double operator()(Vec3 world_mm) const { return at_index(field_.to_index(world_mm)); }
  const grid::Field& field() const { return field_; }
  const grid::Lattice& volume() const { return volume_; }

  /// Where a ray (unit direction) first enters the shape after having been outside, to 1e-3 mm; shapes thinner than
  /// `step_mm` may be missed.
  std::optional<Vec3> enter(Vec3 from_mm, Vec3 direction, double length_mm, double step_mm = 0.7) const;

  /// How far inside the scanned volume a point lies: its distance from the nearest face of the block of voxel centres;
  /// negative outside.
  double depth_in_scan_mm(Vec3 world_mm) const;

 private:
  double at_index(Vec3 ijk) const;
  const grid::Field& field_;
  const grid::Lattice& volume_;
};

/// A sweep in a plane: rays from the centre, turning from `from` (unit) towards `onwards` (unit, perpendicular to it).
struct Sweep {
  Vec3 centre_mm, from, onwards;
  double before_deg = 5, after_deg = 175;  ///< how far to sweep on either side of `from`
  double reach_mm = 220;                   ///< points farther out are not seen
};

/// The outermost point of the surface on each ray of the sweep, every 0.1 degrees; rays that do not meet the surface
/// are left out. `start` is the number of the first point at or after `from`. boolean/outer_curve.h has the same rule
/// for a mesh.
using Outline = surface::Arc;
Outline outline(const FieldView& view, const Sweep& sweep);

/// The outline with new points every `step_mm` of its length, smoothed by a Gaussian along it; the end points stay.
std::vector<Vec3> evenly_spaced(const std::vector<Vec3>& points_mm, double step_mm, double sigma_mm);

}  // namespace trephine::craniometry
