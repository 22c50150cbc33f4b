// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "surface/inside_query.h"

namespace trephine::tetra {

/// The region at a place: the number from 1 of the first of the surfaces that holds it, or 0.
class Regions {
 public:
  explicit Regions(const std::vector<surface::TriMesh>& surfaces) {
    for (const surface::TriMesh& s : surfaces) queries_.emplace_back(s);
  }
  int at(Vec3 world_mm) const {
    for (std::size_t n = 0; n < queries_.size(); ++n)
      if (queries_[n].inside(world_mm)) return int(n) + 1;
    return 0;
  }

 private:
  std::vector<surface::InsideQuery> queries_;
};

}  // namespace trephine::tetra
