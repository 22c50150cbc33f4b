// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>
#include <vector>

#include "grid/grid.h"
#include "itk/transform.h"

namespace trephine::itk {

/// A linear map as an optimizer sees it: 6 numbers of a rigid one (angles about x, y, z times `arm_mm`, shift), or 12
/// of an affine one (rows of the matrix times arm_mm, shift); all in mm, of like effect on a head. Angles and matrix
/// are about the centre.
using Pose = std::vector<double>;
constexpr double arm_mm = 80;

LinearMap map_of(const Pose& pose, Vec3 centre_mm);
Pose rigid_pose(const LinearMap& map, Vec3 centre_mm);
Pose affine_pose(const LinearMap& map, Vec3 centre_mm);

/// Mattes' mutual information of two grids at sampled places. The grids must outlive the object. One thread.
class MutualInformation {
 public:
  MutualInformation(const grid::Grid<float>& fixed, const grid::Grid<float>& moving, const std::vector<Vec3>& places_mm,
                    int bins, Vec3 centre_mm, bool affine);
  ~MutualInformation();

  /// In nats, 0 where under 30 % of the places lie within the moving grid. `uphill`: its derivative.
  double at(const Pose& pose, Pose* uphill = nullptr) const;
  /// Of the last place asked for.
  double overlap_ratio() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace trephine::itk
