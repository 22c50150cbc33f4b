// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <vector>

#include "cases/case.h"
#include "contact/contact.h"

namespace trephine::touch {

/// Of the shapes of a raw CT whose transfer functions have stiffnesses, how stiff a place is by its HU. The place is a
/// voxel's side and a half beneath the surface that is touched, between whose voxels HU are interpolated: those of them
/// that the shape holds. Nearer to the surface voxels are in part of what lies above it.
///
/// at() may be called while another thread lowers voxels; it does not allocate or throw.
class StiffnessRamps {
 public:
  explicit StiffnessRamps(const cases::CaseHaptic& haptic);
  bool any() const { return any_; }
  /// The stiffness there as a share of the shape's largest; 1 for a shape without such a function.
  double ratio_at(const contact::ContactVolume& volume, const contact::Contact& contact) const;

 private:
  struct Ramp {
    std::vector<float> ratio;  // by whole HU from `low` on; empty: none
    int low = 0, high = 0;     // the window
  };
  std::array<Ramp, voxel::haptic_max_shapes + 1> ramps_;
  bool any_ = false;
};

}  // namespace trephine::touch
