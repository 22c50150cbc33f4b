// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "base/exit_code.h"
#include "surface/distance_function.h"
#include "surface/trimesh.h"

namespace trephine {

/// A solid that is cut away: one object for the mesh, for fields and for the haptic volume. World, LPS, mm.
struct Cutter {
  enum class Kind { cylinder, cone, ellipsoid, sphere, mesh } kind = Kind::cylinder;
  std::string name;
  Vec3 position_mm;          ///< cylinder, cone: middle of the axis at the entry (see depth); ellipsoid, sphere: centre
  Vec3 direction{0, 0, -1};  ///< unit: axis, into the body; ellipsoid: its third axis
  Vec3 across{1, 0, 0};      ///< ellipsoid: its first axis, unit, perpendicular to direction
  double radius_mm = 7;      ///< cylinder, sphere; cone: at position_mm
  double end_radius_mm = 7;  ///< cone: at the far end (may be 0)
  std::array<double, 3> radii_mm{7, 7, 7};  ///< ellipsoid
  /// Cylinder, cone: from position_mm - above_mm * direction to position_mm + depth_mm * direction. A cone's side goes
  /// on straight above the entry.
  double above_mm = 20, depth_mm = 20;
  std::shared_ptr<const TriMesh> mesh;  ///< closed, valid
  std::string mesh_file;                ///< where it comes from; only carried through JSON
};

/// Throws Error with that code naming the field: radii and lengths 0.001 to 1e4 mm (end_radius_mm and above_mm may be
/// 0; a cone's radius at its outer end, too), direction of unit length, mesh closed and valid.
void check_cutter(const Cutter& cutter, ExitCode code);

Bounds bounds_of(const Cutter& cutter);
double volume_mm3(const Cutter& cutter);  ///< exact (mesh: of its polyhedron)

/// Signed distance to its surface, positive outside; exact for cylinder, cone, sphere and mesh, for the ellipsoid to
/// 1e-6 mm. Safe from several threads.
DistanceFunction distance_to(const Cutter& cutter);

/// Its surface as a closed, valid mesh whose volume is the exact one to 1e-3 (the rings lie so that the polyhedron has
/// the circle's area), with no point further than max_deviation_mm from it. Deterministic. Throws 80 where that would
/// take more than about 300,000 facets.
TriMesh mesh_of(const Cutter& cutter, double max_deviation_mm = 0.02);

/// Cutters as JSON (kind, name, units in the names), and back. A mesh cutter names its file, which whoever parses has
/// to read: `mesh` is null. Throws 65 naming the field.
std::string cutters_json(const std::vector<Cutter>& cutters);
std::vector<Cutter> parse_cutters_json(const std::string& json);

}  // namespace trephine
