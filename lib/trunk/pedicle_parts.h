// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "trunk/pedicles.h"

namespace trephine::trunk {

/// Signed distance to the bone's surface (positive inside) on a cubic raster along the world's axes.
class BoneDistance {
 public:
  BoneDistance(const grid::Field& bone, const grid::Lattice& raster, const Progress& progress = {});
  double operator()(Vec3 world_mm) const;  ///< well outside of it: -1e3
  const grid::Lattice& raster() const { return grid_; }

 private:
  grid::Grid<float> grid_;
};
/// The field at that point; `outside` beyond its lattice.
double field_at(const grid::Field& field, Vec3 world_mm, double outside);

/// A straight line, from behind forwards.
struct AxisLine {
  Vec3 at_mm, forwards;
};
/// The least distance to the wall within the pedicle, from 6 mm behind to 6 mm before the line's point.
double half_width_mm(const BoneDistance& bone, const AxisLine& line);
/// The same, and so that the line does not graze the body's side farther on: there, up to 20 mm before the point, it
/// must keep 1.15 times that distance.
double clearance_mm(const BoneDistance& bone, const AxisLine& line);

/// What a cross-section of the bone is, seen from a point: rays in its plane to the wall.
struct CrossSection {
  Vec3 middle_mm;
  double area_mm2 = 0, least_mm = 0;
  double closed_ratio = 0;  ///< of directions in which the wall is nearer than 12 mm
};
CrossSection cross_section(const BoneDistance& bone, Vec3 at_mm, Vec3 normal);

/// Where pedicles are, from the canal: a place within each, in ascending order of height.
struct PediclePlace {
  Vec3 at_mm;
  double height_mm = 0;
  bool left = false;
  bool cut = false;  ///< by the end of canal or scan
  Vec3 up{0, 0, 1};  ///< along the canal there
  /// Across the canal, to the patient's left; and forwards.
  Vec3 across() const { return normalized(Vec3{1, 0, 0} - up * up.x); }
  Vec3 forwards() const { return cross(across(), up); }
};
std::vector<PediclePlace> pedicle_places(const grid::Field& bone, const grid::Field& canal,
                                         const PediclesParams& params);

/// The axis through the pedicle about that place.
AxisLine find_axis(const BoneDistance& bone, const PediclePlace& place);
/// By how much a direction leans to the body's middle, and rises along the canal; degrees.
double lean_deg(const PediclePlace& place, Vec3 forwards);
double rise_deg(const PediclePlace& place, Vec3 forwards);

}  // namespace trephine::trunk
