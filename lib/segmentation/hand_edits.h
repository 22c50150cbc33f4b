// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <string>

#include "base/params.h"
#include "base/progress.h"
#include "base/result.h"
#include "grid/grid.h"
#include "segmentation/snake_band.h"

namespace trephine::segmentation {

/// What a person did to a shape otherwise than voxel by voxel. It is kept as what it is, and every run does it again on
/// the shape and the scan that it then has. All positions are LPS, mm.

/// A ball of the person's that grows over what has its HU: a snake by region competition (segmentation/snake.h), within
/// a larger ball about the same place.
struct SnakeEdit {
  bool removes = false;
  std::array<double, 3> seed_mm{0, 0, 0};
  double seed_radius_mm = 2, within_mm = 20;
  double lower_hu = -40, upper_hu = 8;
  double smoothing_sigma_mm = 0.7, curvature = 0.2;
  int steps_count = 25;
  template <class V>
  static void describe(V& v) {
    using P = SnakeEdit;
    v.flag(&P::removes, "removes", "Whether what it covers is taken from the shape, and not added.");
    v.numbers(&P::seed_mm, "seed_mm", Range{-1e6, 1e6}, "Centre of the ball that it begins with.").is_required();
    v.number(&P::seed_radius_mm, "seed_radius_mm", Range{0.1, 30}, "Radius of that ball.");
    v.number(&P::within_mm, "within_mm", Range{1, 60}, "It does not go further than this from the centre.");
    v.number(&P::lower_hu, "lower_hu", Range{-100000, 100000}, "It grows where the scan has at least this many HU.");
    v.number(&P::upper_hu, "upper_hu", Range{-100000, 100000}, "And at most so many.");
    v.number(&P::smoothing_sigma_mm, "smoothing_sigma_mm", Range{0, 5}, "Sigma of the Gaussian against noise.");
    v.number(&P::curvature, "curvature", Range{0, 10}, "Weight of the curvature, which keeps the surface smooth, mm.");
    v.integer(&P::steps_count, "steps_count", Range{0, 2000}, "How many steps of two iterations it evolves.");
  }
  std::string fault() const { return lower_hu < upper_hu ? "" : "lower_hu: must be below upper_hu"; }
};

/// Takes away what lies on one side of a plane, in a ball about a point of the plane.
struct CutEdit {
  std::array<double, 3> point_mm{0, 0, 0}, normal{0, 0, 1};
  double within_mm = 20;
  template <class V>
  static void describe(V& v) {
    using P = CutEdit;
    v.numbers(&P::point_mm, "point_mm", Range{-1e6, 1e6}, "A point of the plane.").is_required();
    v.numbers(&P::normal, "normal", Range{-1, 1}, "Points to the side that is taken away.").is_required();
    v.number(&P::within_mm, "within_mm", Range{1, 1000}, "Nothing is taken further than this from the point.");
  }
  std::string fault() const {
    return normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2] > 1e-6 ? ""
                                                                                        : "normal: is no direction";
  }
};

/// Smooths the shape within a ball: the Gaussian of its mask, cut at one half.
struct SmoothEdit {
  std::array<double, 3> point_mm{0, 0, 0};
  double within_mm = 10, sigma_mm = 1.5;
  template <class V>
  static void describe(V& v) {
    using P = SmoothEdit;
    v.numbers(&P::point_mm, "point_mm", Range{-1e6, 1e6}, "Centre of the ball.").is_required();
    v.number(&P::within_mm, "within_mm", Range{1, 1000}, "Radius of the ball.");
    v.number(&P::sigma_mm, "sigma_mm", Range{0.1, 10}, "Sigma of the Gaussian: what is thinner or smaller goes.");
  }
};

/// The snake of an edit, step by step: a person looks at it while it grows, and a run takes as many steps at once. The
/// same steps give the same bits, whoever takes them and whatever the thread count.
class EditSnake {
 public:
  /// Makes the speed image and the first ball; `steps_count` counts for nothing here. Throws Error 64 where the ball
  /// holds more than 40 million voxels; 80 where the ball that it begins with has none, or lies where the HU do not
  /// fit, and as presegment() does.
  EditSnake(const grid::HuVolume& volume, const SnakeEdit& edit, const Progress& progress = {});
  /// One step of two iterations. Throws Error 80 where the surface vanishes or fills all; Cancelled.
  void advance(const Progress& progress = {});

  int steps() const { return steps_; }
  /// How far the surface went in the last step, on the mean, mm an iteration; 0 before the first.
  double change_mm() const { return change_mm_; }
  /// On the voxels of a part of the volume; positive inside.
  const grid::Field& surface() const { return surface_; }
  /// The surface's inside with its ball, on the voxels of that part.
  grid::Mask mask() const;
  double volume_ml() const;

 private:
  void require_start(const grid::HuVolume& volume, const SnakeEdit& edit) const;

  Vec3 centre_;
  double within_mm_;
  BandParams band_;
  grid::Field speed_, surface_;
  int steps_ = 0;
  double change_mm_ = 0;
};

struct EditedResult {
  double added_ml = 0, removed_ml = 0;
  template <class V>
  static void describe(V& v) {
    v.number(&EditedResult::added_ml, "added_ml", Range{}, "Volume that was added.");
    v.number(&EditedResult::removed_ml, "removed_ml", Range{}, "Volume that was removed.");
  }
};

/// The shape after the edit: the voxels that changed are smoothed as those of a painted correction (corrected()), and
/// further away every value stays. Warns where nothing changes. Throws Error 65 for a
/// field that does not lie on the volume's raster or is not finite; for a snake what EditSnake throws; Cancelled.
Outcome<grid::Field, EditedResult> edited(const grid::Field& field, const grid::HuVolume& volume, const SnakeEdit& edit,
                                          const Progress& progress = {});
Outcome<grid::Field, EditedResult> edited(const grid::Field& field, const grid::HuVolume& volume, const CutEdit& edit,
                                          const Progress& progress = {});
Outcome<grid::Field, EditedResult> edited(const grid::Field& field, const grid::HuVolume& volume,
                                          const SmoothEdit& edit, const Progress& progress = {});

}  // namespace trephine::segmentation
