// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "mask/hu_view.h"
#include "trunk/vein.h"

namespace trephine::trunk {

/// Where a vein usually runs.
struct VeinCourse {
  std::vector<Vec3> points_mm;  ///< from the middle of the body outwards, about 2 mm apart
  double clearance_mm = 0;      ///< least distance to bone and air
  double length_mm() const;
};
VeinCourse estimated_course(const ClavicleCourse& clavicle, const mask::HuView& hu, const grid::Field& bone,
                            const VeinParams& params, const Progress& progress);

/// Distance in mm to the surface of bone and air, negative inside them, in that box of the volume.
grid::Grid<float> room_around(const mask::HuView& hu, const grid::Field& bone, const grid::Box& box,
                              const Progress& progress);

/// The volume's box within margin_mm of the course.
grid::Box box_around(const VeinCourse& course, const grid::Lattice& lattice, double margin_mm);
/// Distance in mm to the course of each voxel of the lattice that is nearer than reach_mm; reach_mm elsewhere.
grid::Grid<float> distance_to(const VeinCourse& course, const grid::Lattice& lattice, double reach_mm);

/// Dense contrast medium is as bright as bone and may have been taken for it. The result is the bone without the pieces
/// that follow the course first estimated from the clavicle, as no rib does, and that are not the clavicle.
grid::Field without_dense_vein(const grid::Field& bone, const ClavicleCourse& clavicle, const VeinParams& params,
                               const Progress& progress);

/// The share of the course that has a voxel of the mask within reach_mm.
double followed(const mask::BitMask& mask, const VeinCourse& course, double reach_mm);

/// The enhanced vein along the course; `found` is false where there is none (contrast_hu then says which contrast there
/// is).
struct EnhancedVein {
  bool found = false;
  double contrast_hu = 0, length_mm = 0, radius_mm = 0;
  grid::Field field;  ///< about mm, on the lattice of box_around(course, volume, search_mm)
};
EnhancedVein enhanced_vein(const mask::HuView& hu, const mask::BitMask& bone, const VeinCourse& course,
                           const VeinParams& params, const Progress& progress);

}  // namespace trephine::trunk
