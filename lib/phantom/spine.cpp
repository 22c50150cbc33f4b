// SPDX-License-Identifier: GPL-3.0-or-later
#include "phantom/spine_parts.h"

#include "base/parallel.h"
#include "base/splitmix64.h"

namespace trephine::phantom {

double hu_of(const Spine& spine, Vec3 p, double width_mm) {
  const auto share = [&](double inside_mm) { return std::clamp(0.5 + inside_mm / width_mm, 0.0, 1.0); };
  const double skin = spine.skin(p);
  if (skin < -width_mm) return -1000;
  const double bone = spine.bone(p);
  const double hu = -1000 + 1045 * share(skin) + share(spine.canal(p)) * (15 - 45) + share(bone) * (900 - 45) +
                    share(bone - 1.5) * (280 - 900);
  if (spine.screws().empty()) return hu;
  return hu + share(spine.metal(p)) * (spine.params().screws.metal_hu - hu);
}

grid::Grid<std::int16_t> scan_of(const Spine& spine, const grid::Lattice& lattice, double noise_hu,
                                 std::uint64_t seed) {
  grid::Grid<std::int16_t> ct(lattice);
  const double voxel = std::min({lattice.spacing_mm.x, lattice.spacing_mm.y, lattice.spacing_mm.z});
  parallel_for(0, lattice.size[2], 1, [&](std::int64_t from, std::int64_t to) {
    for (int k = int(from); k < to; ++k)
      for (int j = 0; j < lattice.size[1]; ++j)
        for (int i = 0; i < lattice.size[0]; ++i) {
          const Vec3 p = lattice.to_world_mm({double(i), double(j), double(k)});
          const double hu = hu_of(spine, p, voxel);
          std::uint64_t random = splitmix64_mixed(seed + splitmix64_step * (lattice.index(i, j, k) + 1));
          double noise = -2;
          for (int n = 0; n < 4; ++n) noise += unit_of_bits(random = splitmix64_mixed(random + splitmix64_step));
          ct.at(i, j, k) = std::int16_t(std::lround(hu + noise_hu * 1.7 * noise));
        }
  });
  return ct;
}

}  // namespace trephine::phantom
