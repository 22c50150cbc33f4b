// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "mask/bits.h"
#include "trunk/clavicle.h"

namespace trephine::trunk {

/// A connected piece of bone in one sagittal plane (index i): runs along the rows (j) of that plane.
struct Blob {
  struct Run {
    int k, begin, end;
  };
  int i = 0;
  std::vector<Run> runs;
  double area_mm2 = 0;
  Vec3 middle;                            ///< continuous index
  double thickness_mm = 0, width_mm = 0;  ///< full lengths of the ellipse of equal second moments
};

/// A chain of round blobs in adjacent planes, or with a gap of a few, which is a candidate for a clavicle.
struct BlobChain {
  BodySide side = BodySide::left;
  std::vector<Blob> blobs;  ///< by rising i
  double span_mm(const grid::Lattice& l) const { return (blobs.back().i - blobs.front().i + 1) * l.spacing_mm.x; }
};

/// At most one chain for each side, the right one first, on that side of the middle of all bone, before it and not far
/// below. `core` is the bone without thin bridges.
std::vector<BlobChain> clavicle_chains(const mask::BitMask& core, const ClavicleParams& params,
                                       const Progress& progress);

}  // namespace trephine::trunk
