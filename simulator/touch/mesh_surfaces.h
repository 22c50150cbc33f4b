// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "surface/inside_query.h"
#include "touch/facet_cells.h"
#include "touch/far_field.h"
#include "touch/felt_mesh.h"
#include "touch/line_distance.h"
#include "voxel/haptic_volume.h"

namespace trephine::touch {

/// Surfaces that are felt beside a haptic volume have the numbers after its shapes.
constexpr int first_mesh_shape = voxel::haptic_max_shapes + 1, max_meshes = 16;
constexpr int max_shape = voxel::haptic_max_shapes + max_meshes;
constexpr bool is_mesh(int shape) { return shape >= first_mesh_shape; }

/// The facets that were near a line of a tool, for the next questions about a line that has hardly moved. It saves
/// time; of what is asked only this depends on it: which of several facets that are as near is named.
struct NearFacets {
  NearFacets();
  void sort();
  void forget() { known = false; }
  static constexpr int most = 4096;
  bool known = false;
  Vec3 from_mm, to_mm;
  double reach_mm = 0;
  int count = 0, last = 0;  ///< the place of the one that was nearest
  int looked_at = 0;        ///< facets since somebody set it to 0, one to which a distance was measured as several
  std::vector<std::uint32_t> facet;  ///< by the tree's order
  std::vector<float> least_mm;       ///< from the line; facets ascend by it but for steps
  std::vector<float> certain_mm;     ///< the same, or more where it was measured since
  std::vector<std::uint32_t> unsorted;
  std::vector<float> unsorted_mm;
  static constexpr int steps = 64;
};

/// Triangle surfaces, closed or open, that stop a tool on both of their sides [Zilles1995]. What a hand meets of them
/// is a skin: a way ends where it would come nearer to a facet than the skin's thickness, on whichever side it is, so
/// that rounding never decides on which side of a surface a tool is. Positions are world coordinates, mm.
///
/// Only the constructor allocates or throws.
class MeshSurfaces {
 public:
  struct Part {
    surface::TriMesh mesh;
    int shape = first_mesh_shape;
  };
  /// `parts`: at least one, at most max_meshes, of different shapes. `skin_mm` is above 0. Throws Error 65 as FeltMesh
  /// does.
  MeshSurfaces(const std::vector<Part>& parts, double skin_mm);

  std::uint64_t shapes() const { return shapes_; }  ///< bit n: shape n
  std::size_t triangles() const { return mesh_.mesh().triangles.size(); }
  double skin_mm() const { return skin_mm_; }

  /// Where a surface is met: `normal` is the facet's, unit, towards the side that the tool is on.
  struct Meeting {
    int shape = 0;  ///< 0: none
    double along = 1;
    Vec3 point_mm, normal;
    bool front = true;  ///< whether that side is the facet's front
    double distance_mm = 0;
  };
  /// Whether the way may come near a surface; said at once.
  bool may_meet(Vec3 from_mm, Vec3 to_mm) const {
    const double least = far_.least_mm(from_mm - origin_mm_) - skin_mm_;
    const Vec3 way = to_mm - from_mm;
    return !(least > 0 && dot(way, way) < least * least);
  }
  /// A distance within which no skin is, said at once.
  double clear_mm(Vec3 place_mm) const { return std::max(0.0, far_.least_mm(place_mm - origin_mm_) - skin_mm_); }
  /// The first place of the way from one point to another where it enters the skin of a surface of those shapes.
  /// `point_mm` lies on the facet.
  Meeting first_met(Vec3 from_mm, Vec3 to_mm, std::uint64_t shapes) const;
  /// The nearest place within `reach_mm` of the line (or point) between two places. The normal points from the surface
  /// to the line, as a round tool feels it; of facets that are as near but for a nanometre it is one.
  Meeting nearest(Vec3 from_mm, Vec3 to_mm, double reach_mm, std::uint64_t shapes) const;
  /// The same, often, of a line that moves little; `reach_mm` is at most `most_mm`.
  Meeting nearest(Vec3 from_mm, Vec3 to_mm, double reach_mm, double most_mm, std::uint64_t shapes,
                  NearFacets& near) const;
  /// Whether the place lies within a closed surface of those shapes.
  bool inside(Vec3 place_mm, std::uint64_t shapes) const;

 private:
  using Sides = std::array<Vec3, 3>;  // across each side of a facet, inward, unit
  struct Facet {                      // in the tree's order
    Vec3 normal, middle;
    double level = 0, radius = 0;  // of its plane along the normal; of the ball around the middle
    int shape = 0;
  };
  struct Solid {
    int shape;
    std::unique_ptr<surface::InsideQuery> query;
  };
  bool wanted(std::uint32_t triangle, std::uint64_t shapes) const { return shapes >> shape_[triangle] & 1; }
  void enter(std::uint32_t triangle, Vec3 from, Vec3 way, Meeting& first) const;
  struct Line {
    Vec3 from, way;
    double share = 0;            // one by the square of its length; 0 for a point
    double begin = 0, part = 1;  // of the tool's line
    Line(Vec3 begin, Vec3 end);
    Vec3 end() const { return from + way; }
    double from_it(Vec3 place) const;  // distance
  };
  struct Place {
    LineToTriangle at;
    double mm = 0;  // the square root of at.squared_mm2; where nothing is found, as far as was looked
    std::uint32_t triangle = 0;
    bool found = false;
  };
  double least_mm(const Facet& facet, const Line& line) const;
  double take(std::size_t facet, const Line& line, std::uint64_t shapes, Place& best) const;
  void gather(const Line& line, double reach_mm, NearFacets& near) const;
  std::optional<Line> near_part(Vec3 from_mm, Vec3 to_mm, double reach_mm) const;
  Place search(const Line& line, double reach_mm, std::uint64_t shapes) const;
  Meeting meeting(const Line& line, const Place& place) const;
  FeltMesh mesh_;
  FarField far_;
  FacetCells cells_;
  Vec3 origin_mm_;
  std::vector<Sides> sides_;
  std::vector<std::uint8_t> shape_;
  std::vector<Facet> facets_;
  std::vector<Solid> solids_;
  std::uint64_t shapes_ = 0;
  double skin_mm_;
};

}  // namespace trephine::touch
