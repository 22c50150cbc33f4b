// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/vec3.h"

namespace trephine::head {

/// A box about the brain's centre, LPS mm, in an adult; heads lie straight to about 15 degrees.
struct BrainBox {
  Vec3 from, to;
  bool holds(Vec3 p) const {
    return p.x >= from.x && p.y >= from.y && p.z >= from.z && p.x <= to.x && p.y <= to.y && p.z <= to.z;
  }
};

}  // namespace trephine::head
