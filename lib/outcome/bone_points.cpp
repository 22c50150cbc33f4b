// SPDX-License-Identifier: GPL-3.0-or-later
#include "outcome/bone_points.h"

#include <cmath>
#include <set>
#include <tuple>

namespace trephine::outcome {
namespace {

constexpr int border_voxels = 3;
constexpr double search_mm = 1.6, search_step_mm = 0.2;

}  // namespace

std::vector<BonePoint> bone_points(const voxel::HapticVolume& volume, int bone, double step_mm) {
  const voxel::HapticDecoder decoder(volume);
  const grid::Lattice& l = volume.voxels;
  std::set<std::tuple<int, int, int, int>> taken;  // a cell, and to which of six sides its surface looks
  std::vector<BonePoint> points;
  for (int k = border_voxels; k < l.size[2] - border_voxels; ++k)
    for (int j = border_voxels; j < l.size[1] - border_voxels; ++j)
      for (int i = border_voxels; i < l.size[0] - border_voxels; ++i) {
        if (decoder.occupancy(bone, i, j, k) < 0.5) continue;
        if (decoder.occupancy(bone, i - 1, j, k) >= 0.5 && decoder.occupancy(bone, i + 1, j, k) >= 0.5 &&
            decoder.occupancy(bone, i, j - 1, k) >= 0.5 && decoder.occupancy(bone, i, j + 1, k) >= 0.5 &&
            decoder.occupancy(bone, i, j, k - 1) >= 0.5 && decoder.occupancy(bone, i, j, k + 1) >= 0.5)
          continue;
        const Vec3 p = l.to_world_mm({double(i), double(j), double(k)});
        const Vec3 gradient = decoder.gradient(bone, p);
        if (norm(gradient) < 0.05) continue;  // a thin place: which side is out is not known
        const Vec3 out = -normalized(gradient);
        int side = 0;
        for (int a = 1; a < 3; ++a)
          if (std::abs(out[a]) > std::abs(out[side])) side = a;
        const auto cell = [&](int index, double spacing) { return int(std::floor(index * spacing / step_mm)); };
        const auto key = std::make_tuple(cell(i, l.spacing_mm.x), cell(j, l.spacing_mm.y), cell(k, l.spacing_mm.z),
                                         2 * side + (out[side] > 0 ? 1 : 0));
        if (taken.count(key)) continue;
        double before = decoder.trilinear(bone, p);
        for (double d = search_step_mm; d <= search_mm; d += search_step_mm) {
          const double now = decoder.trilinear(bone, p + out * d);
          if (before >= 0.5 && now < 0.5) {
            const double part = (before - 0.5) / (before - now);
            points.push_back({p + out * (d - search_step_mm * (1 - part)), out});
            taken.insert(key);
            break;
          }
          before = now;
        }
      }
  return points;
}

}  // namespace trephine::outcome
