// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The surfaces near a place as samples, for tools that are round and not points. Nothing here allocates or throws.
#include <algorithm>
#include <cstdint>
#include <vector>

#include "contact/felt_lattice.h"

namespace trephine::contact {

/// The square of the distance of p from the line (or point) between two places. samples_near() keeps a sample by it.
inline double squared_from_line(Vec3 p, Vec3 from, Vec3 to) {
  const Vec3 way = to - from;
  const double way_squared = dot(way, way);
  Vec3 d = p - from;
  if (way_squared > 0) d = d - way * std::clamp(dot(d, way) / way_squared, 0.0, 1.0);
  return dot(d, d);
}

/// The samples of blocks that were looked at, kept until the block is loosened: the next looks take them from here.
/// Voxels that another thread lowers after it loosened them are seen some frames later. Only the constructor allocates.
class KnownSamples {
 public:
  KnownSamples();
  void begin_frame() { ++frame_; }

  struct Sample {
    Vec3 point_mm;
    std::uint8_t low = 0, high = 0;
  };
  struct Of {
    const Sample* first = nullptr;
    int count = 0;
  };
  /// Those on the edges that begin at the voxels of a block, of which all next voxels are in the lattice; none where
  /// they are too many.
  Of of(const FeltLattice& felt, const KnownBlocks::Block& block, int bi, int bj, int bk);

 private:
  static constexpr int most_blocks_bits = 11, most_of_block = 64, frames_known = 16;
  static constexpr std::size_t most_blocks = std::size_t(1) << most_blocks_bits;
  struct Block {
    std::size_t index = ~std::size_t{0};
    std::uint32_t loosened = 0, frame = 0;
    int count = 0;
  };
  std::vector<Block> blocks_;
  std::vector<Sample> samples_;  // most_of_block of each
  std::uint32_t frame_ = 0;
};

/// What ContactVolume::samples_near gives.
int samples_near(const FeltLattice& felt, Vec3 from_mm, Vec3 to_mm, double reach_mm, SurfaceSample* out, int most,
                 KnownSamples* known);

}  // namespace trephine::contact
