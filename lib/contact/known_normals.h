// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <vector>

#include "contact/contact.h"

namespace trephine::contact {

/// The smooth normals of the places of a surface that were asked for since voxels were last seen to change: looking
/// anew finds most of those places again. Only the constructor allocates.
class KnownNormals {
 public:
  explicit KnownNormals(const ContactVolume& contact) : contact_(contact), normals_(most) {}
  void forget() { ++since_; }
  /// `computed` counts those that were not known.
  Vec3 of(const SurfaceSample& sample, int& computed);

 private:
  static constexpr std::size_t most = 8192;
  struct Known {
    Vec3 point_mm, normal;
    int low = 0, high = 0;
    std::uint64_t since = 0;
  };
  const ContactVolume& contact_;
  std::vector<Known> normals_;
  std::uint64_t since_ = 1;
};

}  // namespace trephine::contact
