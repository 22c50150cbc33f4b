// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxel/shape_field.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/parallel.h"
#include "base/pi.h"
#include "voxel/decode.h"
#include "voxel/hu_shares.h"

namespace trephine::voxel {

bool hole_is_free(const HapticVolume& volume, const std::string& shape, const Bore& bore) {
  const HapticDecoder decoder(volume);
  const int number = volume.find_shape(shape)->number;
  const Vec3 spacing = volume.voxels.spacing_mm;
  const double step_mm = std::min({spacing.x, spacing.y, spacing.z}) / 2, radius_mm = bore.radius_mm - hole_play_mm;
  if (radius_mm <= 0) return true;
  const Vec3 u = normalized(cross(bore.direction, std::abs(bore.direction.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}));
  const Vec3 v = cross(bore.direction, u);
  const int around = std::max(8, static_cast<int>(std::ceil(2 * pi * radius_mm / step_mm)));
  // The ends of the cylinder are as far from what it leaves as its side is.
  for (double t = -bore.above_mm + hole_play_mm; t <= bore.depth_mm - hole_play_mm; t += step_mm)
    for (int ring = 0; ring <= 4; ++ring)
      for (int i = 0; i < around; ++i) {
        const double angle = 2 * pi * i / around, r = radius_mm * ring / 4;
        const Vec3 p = bore.position_mm + bore.direction * t + u * (r * std::cos(angle)) + v * (r * std::sin(angle));
        if (decoder.trilinear(number, p) >= 0.5) return false;
      }
  return true;
}

grid::Field shape_field(const HapticVolume& volume, int number, const Progress& progress) {
  const HapticDecoder decoder(volume);
  std::optional<HuShares> of_hu;
  if (volume.encoding == HapticEncoding::hu) of_hu.emplace(volume, number);
  grid::Field field(static_cast<const grid::Lattice&>(volume.voxels));
  parallel_for(0, field.size[2], 1, [&](std::int64_t from, std::int64_t to) {
    progress.check();
    for (int k = static_cast<int>(from); k < static_cast<int>(to); ++k)
      for (int j = 0; j < field.size[1]; ++j)
        for (int i = 0; i < field.size[0]; ++i)
          field.at(i, j, k) =
              static_cast<float>((of_hu ? of_hu->at(i, j, k) : decoder.occupancy(number, i, j, k)) - 0.5);
  });
  return field;
}

}  // namespace trephine::voxel
