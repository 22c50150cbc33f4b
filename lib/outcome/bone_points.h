// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <vector>

#include "base/vec3.h"
#include "grid/sample.h"
#include "itk/transform.h"
#include "mask/hu_view.h"
#include "voxel/decode.h"

namespace trephine::outcome {

/// A place on the surface of a case's bone, LPS mm; `out` is unit and leads out of the bone.
struct BonePoint {
  Vec3 at_mm, out;
};

/// Places of the surface where a shape's occupancy is 1/2, of outer and inner table alike, about `step_mm` apart. What
/// lies at the end of the volume is an end of what is felt and no surface, and is left out.
std::vector<BonePoint> bone_points(const voxel::HapticVolume& volume, int bone, double step_mm);

/// A scan as HU between its voxels.
class ScanView {
 public:
  /// `bone_hu`: the edge of bone.
  explicit ScanView(const grid::HuVolume& volume, double bone_hu = 300) : hu_(volume), bone_hu_(bone_hu) {}
  static constexpr double beyond_hu = -30000;
  /// beyond_hu where the scan does not reach.
  double operator()(Vec3 lps_mm) const {
    const double v = grid::sampled(
        hu_.lattice(), [this](std::size_t n) { return hu_(n); }, hu_.lattice().to_index(lps_mm),
        grid::value_beyond(beyond_hu));
    return v;
  }
  double bone_hu() const { return bone_hu_; }
  const mask::HuView& voxels() const { return hu_; }
  const grid::Lattice& lattice() const { return hu_.lattice(); }

 private:
  mask::HuView hu_;
  double bone_hu_;
};

}  // namespace trephine::outcome
