// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "base/exit_code.h"
#include "surface/distance_function.h"
#include "surface/trimesh.h"

namespace trephine::boolean {

/// A solid that is cut away: the same object for meshes, fields and haptic volumes. World, LPS, mm.
struct Cutter {
  enum class Kind { cylinder, cone, ellipsoid, sphere, mesh } kind = Kind::cylinder;
  std::string name;
  Vec3 position_mm;  ///< cylinder and cone: point of the axis at the entry (see depth); ellipsoid and sphere: centre
  Vec3 direction{0, 0, -1};                 ///< unit: axis, into the body; ellipsoid: its third axis
  Vec3 across{1, 0, 0};                     ///< ellipsoid: its first axis, unit, perpendicular to direction
  double radius_mm = 7;                     ///< cylinder and sphere; for a cone, at position_mm
  double end_radius_mm = 7;                 ///< cone: at the far end (may be 0)
  std::array<double, 3> radii_mm{7, 7, 7};  ///< ellipsoid
  /// Cylinder and cone reach from position_mm - above_mm * direction to position_mm + depth_mm * direction. A cone's
  /// side continues straight above the entry.
  double above_mm = 20, depth_mm = 20;
  std::shared_ptr<const surface::TriMesh> mesh;  ///< closed, valid
  std::string mesh_file;                         ///< where it comes from; only carried through JSON
};

/// Throws Error with that code, naming the field, unless radii and lengths are 0.001 to 1e4 mm (end_radius_mm, above_mm
/// and a cone's radius at its outer end may be 0), the direction has unit length, and the mesh is closed and valid.
void check_cutter(const Cutter& cutter, ExitCode code);

surface::Bounds bounds_of(const Cutter& cutter);
double volume_mm3(const Cutter& cutter);  ///< exact (for a mesh: of its polyhedron)

/// Signed distance to the cutter's surface, positive outside; exact for cylinder, cone, sphere and mesh, to 1e-6 mm for
/// the ellipsoid. Safe from several threads.
surface::DistanceFunction distance_to(const Cutter& cutter);

/// The cutter's surface as a closed, valid mesh whose volume is the exact one to 1e-3 (the rings are placed so that the
/// polyhedron has the circle's area), with no point further than max_deviation_mm from the surface. Deterministic.
/// Throws Error 80 where that would take more than about 300,000 facets.
surface::TriMesh mesh_of(const Cutter& cutter, double max_deviation_mm = 0.02);

/// Writes cutters as JSON (kind, name, units in the names), and reads them back. A mesh cutter names its file, which
/// the caller has to read: its `mesh` is null. Throws Error 65 naming the field.
std::string cutters_json(const std::vector<Cutter>& cutters);
std::vector<Cutter> parse_cutters_json(const std::string& json);

}  // namespace trephine::boolean
