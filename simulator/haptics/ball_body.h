// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "contact/contact.h"

namespace trephine {

/// An exactly round ball in a haptic volume. Surfaces near it are discs: one at each place where the surface crosses an
/// edge between voxel centres, with the surface's smooth normal there, and as wide as neighbouring discs need to leave
/// no gap. The ball's distance to each is exact.
///
/// The surface is looked up again when the ball has moved by half a voxel, and after forget(). Only the constructor
/// allocates.
class BallBody {
 public:
  BallBody(const ContactVolume& contact, double radius_mm);
  double radius_mm() const { return radius_mm_; }

  /// Must be called where voxels may have changed.
  void forget() { known_ = false; }

  /// The disc into which the ball, with its centre there, reaches deepest, of those whose crossing from `inside` stops
  /// it. The contact's point is where the ball touches it, and its normal points to the ball's centre.
  struct Touch {
    bool hit = false;
    double depth_mm = 0;
    Contact contact;
  };
  Touch deepest(Vec3 centre_mm, int inside, const TouchableFaces& faces);
  /// Whether the ball reaches any surface of one of these shapes (bit n: shape n).
  bool reaches(Vec3 centre_mm, std::uint64_t shapes);

 private:
  void look(Vec3 centre_mm);
  const ContactVolume& contact_;
  double radius_mm_, disc_mm_, margin_mm_;
  std::vector<SurfaceSample> samples_;
  int count_ = 0;
  Vec3 centre_mm_;
  bool known_ = false;
};

}  // namespace trephine
