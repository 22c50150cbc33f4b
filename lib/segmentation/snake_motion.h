// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>

#include "grid/grid.h"
#include "segmentation/snake_band.h"
#include "segmentation/snake_spacing.h"

namespace trephine::segmentation {

/// The speed at or below which a voxel is a wall, where there is advection: the surface must not go there.
constexpr float snake_wall = -1;

/// How fast the surface moves at one voxel: the right side of the snake's equation, for voxels beside the surface. It
/// reads the neighbours of the voxel in phi, which must hold a distance there (mm, positive inside), and changes
/// nothing; many threads may ask at once. The speed, phi and what is asked for must outlive it.
class SnakeMotion {
 public:
  /// No time step is longer than longest_step (mm per unit of speed).
  SnakeMotion(const grid::Grid<float>& speed, const grid::Grid<float>& phi, const BandParams& params,
              float longest_step)
      : l_(phi),
        g_(speed),
        phi_(phi),
        s_(l_),
        advection_(params.advection != 0),
        weight_{float(params.propagation), float(params.curvature), float(params.advection)},
        longest_(longest_step) {}

  struct Rate {
    float rate;        ///< of phi, mm per unit of time; positive: the surface moves outwards
    float hyperbolic;  ///< the speed without the curvature's part, which bounds the time step
  };
  /// Of voxel `at`, whose index is v.
  Rate rate(const int at[3], std::size_t v) const { return advection_ ? rate_of<true>(at, v) : rate_of<false>(at, v); }

 private:
  struct Vec3f {
    float v[3];
  };
  template <bool Advection>
  Rate rate_of(const int at[3], std::size_t v) const;
  template <bool Advection>
  float driven(const int at[3], std::size_t v, const float inwards[3]) const;
  Vec3f speed_slope(const int at[3], std::size_t v) const;

  const grid::Lattice l_;
  const grid::Grid<float>& g_;
  const grid::Grid<float>& phi_;
  const SnakeSpacing s_;
  const bool advection_;
  const float weight_[3];  ///< of propagation, curvature, advection
  const float longest_;
};

}  // namespace trephine::segmentation
