// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>

#include "drill/cutter.h"
#include "grid/grid.h"

namespace trephine::drill {

/// The ramp that a cutter leaves to each side of its surface, in voxels: 1, but of a narrow one down to 1/2.
double ramp_voxels(const Cutter& cutter, const grid::Lattice& lattice);

/// The solid that a cutter fills on a short straight way, as a surface to a fraction of a voxel and not by the voxels'
/// middles. All positions are in mm along the lattice's own axes, counted from its first voxel's middle.
class CutterBody {
 public:
  CutterBody(const Cutter& cutter, const ToolPose& from, Vec3 to_tip_mm, const Wider& wider,
             const grid::Lattice& lattice);

  /// What may stay of a voxel, 0 to 1, so that the surface of half occupancy is that of the solid: a ramp to each
  /// side (ramp_voxels). And the weight of the law of removal there [Rizzi, chapter 6], counted to the ramp's end.
  struct At {
    double stays = 1, weight = 0;
  };
  At at(Vec3 lattice_mm) const;
  /// A ball that holds every voxel of which less than all stays.
  Vec3 middle_mm() const { return middle_; }
  double reach_mm() const { return reach_; }

 private:
  double wider_at(Vec3 p) const;
  At ball_at(Vec3 p, double wider_mm) const;
  At cylinder_at(Vec3 p, double wider_mm) const;
  double voxel_across(Vec3 unit) const;

  static constexpr int max_places = 17;
  Vec3 begin_, way_, middle_, spacing_;
  Mat3 frame_;  // of a cylinder, along the lattice's axes
  double radius_ = 0, way_squared_ = 0, semi_a_ = 0, semi_b_ = 0, height_ = 0, reach_ = 0, ramp_ = 0, most_ = 0,
         steep_ = 1;
  Wider wider_;  // its places along the lattice's axes
  int places_ = 1;
  double end_ = 0;  // where the half ball of a round end has its middle; 0: the end is flat
  bool cylinder_ = false;
};

}  // namespace trephine::drill
