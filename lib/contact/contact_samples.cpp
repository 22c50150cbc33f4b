// SPDX-License-Identifier: GPL-3.0-or-later
// The surfaces near a place as samples, for tools that are round and not points.
#include <algorithm>
#include <cmath>

#include "contact/contact.h"
#include "contact/contact_cell.h"
#include "contact/contact_way.h"
#include "voxel/raw_voxel.h"

namespace trephine {
namespace {

int shape_of_entry(std::uint32_t e) { return 2 * entry_filled(e) > haptic_full ? entry_shape(e) : 0; }

// Where between two voxels of different shapes the surface is, 0 to 1.
double crossing_of(std::uint32_t a, std::uint32_t b) {
  if (shape_of_entry(a) == 0 || shape_of_entry(b) == 0) {
    const double half = 0.5 * haptic_full, from = entry_filled(a), to = entry_filled(b);
    return from != to ? std::clamp((half - from) / (to - from), 0.0, 1.0) : 0.5;
  }
  const double own = entry_share(a) - entry_rest(a), other = entry_share(b) - entry_rest(b);
  return own + other > 0 ? std::clamp(own / (own + other), 0.0, 1.0) : 0.5;
}

}  // namespace

int ContactVolume::samples_near(Vec3 centre_mm, double reach_mm, SurfaceSample* out, int most) const {
  if (!detail::usable(centre_mm)) return 0;
  const Grid<std::int16_t>& v = volume_.voxels;
  const Vec3 c = to_index(centre_mm);
  int low[3], high[3];
  for (int a = 0; a < 3; ++a) {
    const double reach = reach_mm / v.spacing_mm[a] + 1;
    low[a] = int(std::clamp(std::floor(c[a] - reach), -1.0, double(v.size[std::size_t(a)])));
    high[a] = int(std::clamp(std::ceil(c[a] + reach), -1.0, double(v.size[std::size_t(a)])));
  }
  const std::size_t step[3] = {1, std::size_t(v.size[0]), std::size_t(v.size[0]) * std::size_t(v.size[1])};
  const bool hu = volume_.encoding == HapticEncoding::hu;
  int count = 0;
  constexpr int side = 1 << block_bits;
  const auto entry_at = [&](int i, int j, int k) {
    return v.contains(i, j, k) ? table_[std::uint16_t(detail::load_voxel(v.at(i, j, k)))] : 0;
  };
  for (int bk = low[2] >> block_bits; bk <= high[2] >> block_bits; ++bk)
    for (int bj = low[1] >> block_bits; bj <= high[1] >> block_bits; ++bj)
      for (int bi = low[0] >> block_bits; bi <= high[0] >> block_bits; ++bi) {
        if (shape_of_block(bi * side, bj * side, bk * side) != mixed_block) continue;
        for (int k = std::max(low[2], bk * side); k <= std::min(high[2], bk * side + side - 1); ++k)
          for (int j = std::max(low[1], bj * side); j <= std::min(high[1], bj * side + side - 1); ++j) {
            for (int i = std::max(low[0], bi * side); i <= std::min(high[0], bi * side + side - 1); ++i) {
              const bool inner =
                  i >= 0 && j >= 0 && k >= 0 && i + 1 < v.size[0] && j + 1 < v.size[1] && k + 1 < v.size[2];
              const std::int16_t* at = inner ? v.voxels.data() + v.index(i, j, k) : nullptr;
              const std::uint32_t here = inner ? table_[std::uint16_t(detail::load_voxel(*at))] : entry_at(i, j, k);
              const int shape = shape_of_entry(here);
              for (int a = 0; a < 3; ++a) {
                const std::uint32_t next = inner ? table_[std::uint16_t(detail::load_voxel(at[step[a]]))]
                                                 : entry_at(i + (a == 0), j + (a == 1), k + (a == 2));
                const int other = shape_of_entry(next);
                if (other == shape) continue;
                Vec3 p{double(i), double(j), double(k)};
                p[a] += hu ? 0.5 : crossing_of(here, next);
                const Vec3 world = v.to_world_mm(p), d = world - centre_mm;
                if (dot(d, d) > reach_mm * reach_mm || count == most) continue;
                out[count++] = {world, {}, std::uint8_t(shape), std::uint8_t(other)};
              }
            }
          }
      }
  return count;
}

}  // namespace trephine
