// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "base/params.h"
#include "base/progress.h"
#include "base/result.h"
#include "surface/trimesh.h"

namespace trephine::tetra {

/// A volume in tetrahedra, world (LPS) mm. Regions that meet share the points and triangles of their border.
struct TetraMesh {
  std::vector<std::string> regions;  ///< region n is named regions[n - 1]; 0 is outside
  std::vector<Vec3> points_mm;
  /// Each has a positive volume: the fourth corner lies where the first three are seen counter-clockwise from the
  /// other side, as VTK, Gmsh and CalculiX number them.
  std::vector<std::array<std::uint32_t, 4>> tetrahedra;
  std::vector<std::uint8_t> region_of;  ///< of each tetrahedron, 1 and more
  /// The triangles between two regions, or between one and what is outside. Each lies on the surface of between[0], and
  /// looks out of it.
  std::vector<std::array<std::uint32_t, 3>> borders;
  std::vector<std::array<std::uint8_t, 2>> between;
};

/// A closed surface and its name.
struct NamedSurface {
  std::string name;
  const surface::TriMesh* mesh = nullptr;
};

struct TetraParams {
  double size_mm = 6, border_mm = 0.5;
  template <class V>
  static void describe(V& v) {
    using P = TetraParams;
    v.number(
        &P::size_mm, "size_mm", Range{0.2, 100},
        "tetra-vtu, tetra-msh: largest radius of the ball through the corners of a tetrahedron, or of a triangle of a "
        "border.");
    v.number(&P::border_mm, "border_mm", Range{0.01, 20},
             "tetra-vtu, tetra-msh: how far the middle of a border's triangle may lie off the case's surface.");
  }
};

/// What one region is, and how it compares with its surface.
struct RegionResult {
  std::size_t tetrahedra_count = 0, borders_count = 0;
  double volume_ml = 0, counted_volume_ml = 0;
  double deviation_max_mm = 0, deviation_p99_mm = 0, deviation_rms_mm = 0;
  template <class V>
  static void describe(V& v) {
    using P = RegionResult;
    v.integer(&P::tetrahedra_count, "tetrahedra_count", Range{}, "Tetrahedra.");
    v.integer(&P::borders_count, "borders_count", Range{}, "Triangles of borders that lie on its surface.");
    v.number(&P::volume_ml, "volume_ml", Range{}, "Volume of the tetrahedra.");
    v.number(&P::counted_volume_ml, "counted_volume_ml", Range{},
             "Volume within its surface and within no surface of a smaller volume, counted on a lattice.");
    v.number(&P::deviation_max_mm, "deviation_max_mm", Range{},
             "Largest distance of those triangles from the surface, and of the surface, where it is within no smaller "
             "one, from the nearest border.");
    v.number(&P::deviation_p99_mm, "deviation_p99_mm", Range{}, "99th percentile of the distances.");
    v.number(&P::deviation_rms_mm, "deviation_rms_mm", Range{}, "Root mean square of the distances.");
  }
};

/// Quality of tetrahedra: how far they are from a flat one (0) and from a regular one.
struct TetraQuality {
  double dihedral_min_deg = 0, dihedral_p1_deg = 0, dihedral_median_deg = 0, dihedral_max_deg = 0;
  double ratio_min = 0, ratio_p1 = 0, ratio_median = 0;
  template <class V>
  static void describe(V& v) {
    using P = TetraQuality;
    v.number(&P::dihedral_min_deg, "dihedral_min_deg", Range{},
             "Least angle between two faces; 70.5 in a regular one.");
    v.number(&P::dihedral_p1_deg, "dihedral_p1_deg", Range{}, "First percentile of the least angle of each.");
    v.number(&P::dihedral_median_deg, "dihedral_median_deg", Range{}, "Median of the least angle of each.");
    v.number(&P::dihedral_max_deg, "dihedral_max_deg", Range{}, "Largest angle between two faces.");
    v.number(&P::ratio_min, "ratio_min", Range{},
             "Least of three times the inner ball's radius by the outer one's; 1 in a regular one.");
    v.number(&P::ratio_p1, "ratio_p1", Range{}, "First percentile.");
    v.number(&P::ratio_median, "ratio_median", Range{}, "Median.");
  }
};

struct TetraResult {
  std::size_t points_count = 0, tetrahedra_count = 0, borders_count = 0, joined_count = 0;
  TetraQuality quality;
  Named<RegionResult> regions;
  template <class V>
  static void describe(V& v) {
    using P = TetraResult;
    v.integer(&P::points_count, "points_count", Range{}, "Points.");
    v.integer(&P::tetrahedra_count, "tetrahedra_count", Range{}, "Tetrahedra.");
    v.integer(&P::borders_count, "borders_count", Range{}, "Triangles of borders.");
    v.integer(&P::joined_count, "joined_count", Range{},
              "Tetrahedra that hung together with no more of their region, and were given to the one beside them.");
    v.group(&P::quality, "quality", "Of the tetrahedra.");
    v.map(&P::regions, "regions", "By name.");
  }
};

/// Fills the surfaces with tetrahedra. A place belongs to the surface of the least volume that holds it, so that what
/// lies within another is a region of its own, and where surfaces overlap the smaller one has the place: there is
/// neither a gap nor an overlap between regions. By CGAL's Mesh_3 [Jamin2015] (Delaunay refinement of a labelled
/// domain, then perturbation and exudation of slivers) in a bounded child, trephine-tetra. The same bytes for the same
/// input.
///
/// Throws Error 64 where there would be more than 20 million; 65 for a surface that is not closed, or that has no
/// volume; 70 where trephine-tetra is missing, dies or is over its limits; 80 where a tetrahedron is inverted, or a
/// region's volume is more than a tenth off what is counted, because the tetrahedra are too large for it.
Outcome<TetraMesh, TetraResult> fill_with_tetrahedra(const std::vector<NamedSurface>& surfaces,
                                                     const TetraParams& params, const Progress& progress = {});

/// Throws Error 80 where a tetrahedron has no positive volume.
TetraQuality quality_of(const TetraMesh& mesh);
double volume_mm3(const TetraMesh& mesh, std::size_t tetrahedron);
/// The borders' triangles on the surface of one region, with their points; 0: of all.
surface::TriMesh borders_of(const TetraMesh& mesh, std::uint8_t region);

/// The bytes of a .vtu file (VTK, XML, ASCII): tetrahedra, then the borders' triangles, with the cell data `region` and
/// `beyond` (0 for tetrahedra), and field data of one number for each region, by its name.
std::string encode_vtu(const TetraMesh& mesh);
/// The bytes of a .msh file (Gmsh 2.2, ASCII): a physical volume for each region, and a physical surface for each pair
/// of regions that meet, named "skull|brain" or "skin|outside".
std::string encode_msh(const TetraMesh& mesh);

}  // namespace trephine::tetra
