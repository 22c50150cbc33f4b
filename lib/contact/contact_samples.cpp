// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/contact_samples.h"

#include <algorithm>
#include <cmath>

#include "contact/contact_cell.h"
#include "contact/crossing.h"
#include "voxel/raw_voxel.h"

namespace trephine::contact {
namespace {

int shape_of_entry(std::uint32_t e) { return 2 * entry_filled(e) > voxel::haptic_full ? entry_shape(e) : 0; }

// Where the surface lies between two voxels of different shapes, 0 to 1.
double crossing_of(std::uint32_t a, std::uint32_t b) {
  if (shape_of_entry(a) == 0 || shape_of_entry(b) == 0) {
    const double half = 0.5 * voxel::haptic_full, from = entry_filled(a), to = entry_filled(b);
    return from != to ? std::clamp((half - from) / (to - from), 0.0, 1.0) : 0.5;
  }
  const double own = entry_share(a) - entry_rest(a), other = entry_share(b) - entry_rest(b);
  return own + other > 0 ? std::clamp(own / (own + other), 0.0, 1.0) : 0.5;
}

// The same of encoding `hu`.
double crossing_of_hu(const VoxelTable& table, int from, int to) {
  const int a = entry_shape(table.of(std::int16_t(from))), b = entry_shape(table.of(std::int16_t(to)));
  const int upper = from > to ? a : b, lower = from > to ? b : a;
  const double hu = lower != 0 ? table.top_of(lower, upper) : table.low_of(upper);
  return std::clamp((hu - from) / (to - from), 0.0, 1.0);
}

// A part of a line, as shares of its length.
struct Part {
  double begin, end;
};

// The samples on the edges that begin at the voxels of a part of a row. `inner`: all their next voxels are in the
// lattice.
template <class Keep>
void samples_of_row(const FeltLattice& felt, const KnownBlocks::Block& block, bool inner, int begin_i, int end_i, int j,
                    int k, const Keep& keep) {
  constexpr int side = 1 << KnownBlocks::block_bits;
  const grid::Grid<std::int16_t>& v = felt.volume.voxels;
  const bool hu = felt.volume.encoding == voxel::HapticEncoding::hu;
  const std::size_t step[3] = {1, std::size_t(v.size[0]), std::size_t(v.size[0]) * std::size_t(v.size[1])};
  const auto raw_at = [&](int i, int j, int k) {
    return v.contains(i, j, k) ? voxel::detail::load_voxel(v.at(i, j, k))
           : hu                ? std::int16_t(voxel::haptic_beyond_hu)
                               : voxel::haptic_empty;
  };
  const unsigned mixed = inner ? felt.blocks.mixed_cells(block, j, k) : ~0u;
  if (mixed == 0) return;
  const std::int16_t* row = inner ? v.voxels.data() + v.index(0, j, k) : nullptr;
  for (int i = begin_i; i <= end_i; ++i) {
    if (!(mixed >> 2 * (i & (side - 1)) & 1)) continue;
    std::int16_t raw, beside[3];
    if (inner) {
      const std::int16_t* at = row + i;
      raw = voxel::detail::load_voxel(*at);
      for (int a = 0; a < 3; ++a) beside[a] = voxel::detail::load_voxel(at[step[a]]);
    } else {
      raw = raw_at(i, j, k);
      for (int a = 0; a < 3; ++a) beside[a] = raw_at(i + (a == 0), j + (a == 1), k + (a == 2));
    }
    if (raw == beside[0] && raw == beside[1] && raw == beside[2]) continue;  // most are
    const std::uint32_t here = felt.table.of(raw);
    const int shape = shape_of_entry(here);
    for (int a = 0; a < 3; ++a) {
      const std::uint32_t next = felt.table.of(beside[a]);
      const int other = shape_of_entry(next);
      if (other == shape) continue;
      Vec3 p{double(i), double(j), double(k)};
      p[a] += hu ? crossing_of_hu(felt.table, raw, beside[a]) : crossing_of(here, next);
      keep(v.to_world_mm(p), shape, other);
    }
  }
}

}  // namespace

KnownSamples::KnownSamples() : blocks_(most_blocks), samples_(most_blocks * most_of_block) {}

KnownSamples::Of KnownSamples::of(const FeltLattice& felt, const KnownBlocks::Block& block, int bi, int bj, int bk) {
  constexpr int side = 1 << KnownBlocks::block_bits;
  const std::size_t place = (block.index * 0x9e3779b97f4a7c15) >> (64 - most_blocks_bits);
  Block& known = blocks_[place];
  Sample* const first = samples_.data() + place * most_of_block;
  const bool lasts = block.loosened == 0 || frame_ - known.frame < frames_known;
  if (known.index == block.index && known.loosened == block.loosened && lasts)
    return known.count <= most_of_block ? Of{first, known.count} : Of{};
  known = {block.index, block.loosened, frame_, 0};
  const auto keep = [&](Vec3 at, int low, int high) {
    if (known.count < most_of_block) first[known.count] = {at, std::uint8_t(low), std::uint8_t(high)};
    ++known.count;
  };
  for (int k = bk * side; k < (bk + 1) * side; ++k)
    for (int j = bj * side; j < (bj + 1) * side; ++j)
      samples_of_row(felt, block, true, bi * side, bi * side + side - 1, j, k, keep);
  return known.count <= most_of_block ? Of{first, known.count} : Of{};
}

int samples_near(const FeltLattice& felt, Vec3 from_mm, Vec3 to_mm, double reach_mm, SurfaceSample* out, int most,
                 KnownSamples* known) {
  if (!detail::usable(from_mm) || !detail::usable(to_mm)) return 0;
  const grid::Grid<std::int16_t>& v = felt.volume.voxels;
  const Vec3 c = felt.to_index(from_mm), along = felt.to_index(to_mm) - c, way = to_mm - from_mm;
  const double way_squared = dot(way, way);
  Vec3 reach;  // in voxels
  for (int a = 0; a < 3; ++a) reach[a] = reach_mm / v.spacing_mm[a] + 1;
  // The voxels along axis a within reach of the part t of the line; part_near is the part that reaches a block.
  const auto voxels_of = [&](int a, Part t) {
    const double p = c[a] + along[a] * t.begin, q = c[a] + along[a] * t.end, max_voxel = v.size[std::size_t(a)];
    return std::array<int, 2>{int(std::clamp(std::floor(std::min(p, q) - reach[a]), -1.0, max_voxel)),
                              int(std::clamp(std::ceil(std::max(p, q) + reach[a]), -1.0, max_voxel))};
  };
  constexpr int side = 1 << KnownBlocks::block_bits;
  const auto part_near = [&](int a, Part t, int block) {
    if (std::abs(along[a]) < 1e-9) return t;
    const double p = (block * side - reach[a] - 1 - c[a]) / along[a];
    const double q = (block * side + side + reach[a] + 1 - c[a]) / along[a];
    return Part{std::max(t.begin, std::min(p, q)), std::min(t.end, std::max(p, q))};
  };
  int count = 0;
  const auto keep = [&](Vec3 at, int low, int high) {
    if (squared_from_line(at, from_mm, to_mm) > reach_mm * reach_mm || count == most) return;
    out[count++] = {at, {}, std::uint8_t(low), std::uint8_t(high)};
  };
  // Around a point, how far the row of voxels (j, k) lies within reach; negative where it does not. A sample lies up to
  // one voxel behind its voxel.
  const double per_x = (1 + 1e-9) / v.spacing_mm.x;
  const auto half_row = [&](int j, int k) {
    const double y = v.spacing_mm.y * std::max({0.0, j - c.y, c.y - (j + 1)});
    const double z = v.spacing_mm.z * std::max({0.0, k - c.z, c.z - (k + 1)});
    const double left = reach_mm * reach_mm * (1 + 1e-9) + 1e-9 - y * y - z * z;
    return left < 0 ? -1 : std::sqrt(left) * per_x;
  };
  // The samples of a block's voxels lie within a ball about its middle.
  const double block_mm = 0.5 * side * norm(v.spacing_mm), block_reach_mm = (reach_mm + block_mm) * (1 + 1e-9);
  const auto block_is_near = [&](int bi, int bj, int bk) {
    const Vec3 middle = v.to_world_mm({(bi + 0.5) * side, (bj + 0.5) * side, (bk + 0.5) * side});
    return squared_from_line(middle, from_mm, to_mm) <= block_reach_mm * block_reach_mm;
  };
  const auto [low_k, high_k] = voxels_of(2, {0, 1});
  for (int bk = low_k >> KnownBlocks::block_bits; bk <= high_k >> KnownBlocks::block_bits; ++bk) {
    const Part of_slice = part_near(2, {0, 1}, bk);
    if (of_slice.begin > of_slice.end) continue;
    const auto [low_j, high_j] = voxels_of(1, of_slice);
    for (int bj = low_j >> KnownBlocks::block_bits; bj <= high_j >> KnownBlocks::block_bits; ++bj) {
      const Part of_row = part_near(1, of_slice, bj);
      if (of_row.begin > of_row.end) continue;
      const auto [low_i, high_i] = voxels_of(0, of_row);
      for (int bi = low_i >> KnownBlocks::block_bits; bi <= high_i >> KnownBlocks::block_bits; ++bi) {
        const KnownBlocks::Block block = felt.blocks.block(bi, bj, bk);
        if (block.shape < KnownBlocks::mixed_block || !block_is_near(bi, bj, bk)) continue;
        const bool inner = bi >= 0 && bj >= 0 && bk >= 0 && (bi + 1) * side < v.size[0] &&
                           (bj + 1) * side < v.size[1] && (bk + 1) * side < v.size[2];
        const KnownSamples::Of of = known && inner ? known->of(felt, block, bi, bj, bk) : KnownSamples::Of{};
        if (!of.first) {
          for (int k = std::max(low_k, bk * side); k <= std::min(high_k, bk * side + side - 1); ++k)
            for (int j = std::max(low_j, bj * side); j <= std::min(high_j, bj * side + side - 1); ++j) {
              int begin_i = std::max(low_i, bi * side), end_i = std::min(high_i, bi * side + side - 1);
              if (!(way_squared > 0)) {
                const double half = half_row(j, k);
                if (half < 0) continue;
                begin_i = std::max(begin_i, int(c.x - half) - 1);
                end_i = std::min(end_i, int(c.x + half) + 1);
              }
              samples_of_row(felt, block, inner, begin_i, end_i, j, k, keep);
            }
          continue;
        }
        for (int n = 0; n < of.count; ++n) keep(of.first[n].point_mm, of.first[n].low, of.first[n].high);
      }
    }
  }
  return count;
}

}  // namespace trephine::contact
