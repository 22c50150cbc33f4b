// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What is kept of a point's measurements besides the results of its stages.
#include <cstdint>
#include <vector>

#include "base/params.h"
#include "voxel/mismatch.h"

namespace trephine::trade {

struct PublishedAnatomy {
  std::int64_t triangles = 0, bytes = 0;
  double volume_ml = 0, deviation_max_mm = 0;
  template <class V>
  static void describe(V& v) {
    using P = PublishedAnatomy;
    v.integer(&P::triangles, "triangles", Range{}, "Triangles.");
    v.integer(&P::bytes, "bytes", Range{}, "Size of the file.");
    v.number(&P::volume_ml, "volume_ml", Range{}, "Volume.");
    v.number(&P::deviation_max_mm, "deviation_max_mm", Range{}, "Largest distance to the unreduced surface.");
  }
};

struct Published {
  std::size_t bytes = 0;
  std::vector<PublishedAnatomy> anatomies;  ///< in the order of the graph's
  template <class V>
  static void describe(V& v) {
    v.integer(&Published::bytes, "bytes", Range{}, "Size of all files.");
    v.list(&Published::anatomies, "anatomies", "The surfaces.");
  }
};

/// How far both felt surfaces of a shape lie from the displayed one.
struct Felt {
  voxel::Mismatch sub_voxel, nearest;
  template <class V>
  static void describe(V& v) {
    v.all_of(&Felt::sub_voxel, "sub_voxel_");
    v.all_of(&Felt::nearest, "nearest_");
  }
};

}  // namespace trephine::trade
