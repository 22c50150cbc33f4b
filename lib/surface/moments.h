// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>

#include "surface/trimesh.h"

namespace trephine::surface {

/// Integrals over what a closed surface encloses, about the world's origin: of 1 (mm³), of the place (mm⁴) and of its
/// products xx, yy, zz, xy, xz, yz (mm⁵), by signed tetrahedra [Tonon2005]. They are added and subtracted as volumes
/// are.
struct Moments {
  double volume = 0;
  Vec3 first;
  std::array<double, 6> second{};

  Moments& add(const Moments& other, double factor);
  Vec3 centre() const { return first / volume; }
  /// Moments of inertia about the centre, of density 1, along the world's axes: xx, yy, zz, xy, xz, yz (mm⁵).
  std::array<double, 6> inertia() const;
};
Moments moments_of(const TriMesh& mesh);

}  // namespace trephine::surface
