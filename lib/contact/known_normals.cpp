// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/known_normals.h"

#include <cstring>

namespace trephine::contact {

Vec3 KnownNormals::of(const SurfaceSample& s, int& computed) {
  std::uint64_t hash = std::uint64_t(s.low) << 8 ^ std::uint64_t(s.high);
  for (const double x : {s.point_mm.x, s.point_mm.y, s.point_mm.z}) {
    std::uint64_t bits;
    std::memcpy(&bits, &x, sizeof bits);
    hash = (hash ^ bits) * 0x9e3779b97f4a7c15;
    hash ^= hash >> 29;
  }
  Known& known = normals_[hash % most];
  if (known.since == since_ && known.point_mm == s.point_mm && known.low == s.low && known.high == s.high)
    return known.normal;
  ++computed;
  known = {s.point_mm, contact_.normal_at(s.point_mm, s.low, s.high), s.low, s.high, since_};
  return known.normal;
}

}  // namespace trephine::contact
