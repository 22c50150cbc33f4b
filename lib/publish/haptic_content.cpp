// SPDX-License-Identifier: GPL-3.0-or-later
#include "publish/haptic_content.h"

#include <algorithm>

#include "voxel/haptic_file.h"
#include "voxel/mismatch.h"

namespace trephine::publish {

HapticContent make_haptic_content(const config::CaseConfig& config, const voxel::HapticVolume& volume,
                                  const voxel::VoxelizeResult& made, const voxel::MismatchResult& mismatch) {
  HapticContent out;
  out.bytes = voxel::encode_haptic(volume);
  if (!volume.hardness.voxels.empty()) out.hardness_bytes = voxel::encode_hardness(volume);
  cases::CaseHaptic& m = out.manifest;
  m.encoding = volume.encoding == voxel::HapticEncoding::hu ? "hu" : "occupancy";
  m.size = volume.voxels.size;
  m.spacing_mm = volume.voxels.spacing_mm;
  for (const config::SceneShape& wanted : config.haptic.shapes) {
    const voxel::HapticShape& shape = *volume.find_shape(wanted.name);
    cases::CaseShape s;
    s.name = shape.name;
    s.number = shape.number;
    s.window_low = shape.window_low;
    s.window_high = shape.window_high;
    s.material = wanted.material;
    static_cast<cases::ShapeParams&>(s) = wanted;
    s.volume_ml = part_of(made.shapes, shape.name).volume_ml;
    const bool seen = config.find_shown(shape.name);
    s.displayed = seen ? "surface" : "haptic";
    if (seen) {
      const voxel::Mismatch& m = part_of(mismatch.shapes, shape.name);
      s.mismatch = {m.bias_mm, m.rms_mm, m.p99_mm, m.max_mm, m.missed_ratio, m.samples};
    } else {
      cases::CaseAnatomy a;
      a.name = shape.name;
      a.colour_rgb = wanted.material.colour_rgb;
      a.volume_ml = s.volume_ml;
      out.anatomies.push_back(std::move(a));
    }
    m.shapes.push_back(std::move(s));
  }
  std::sort(m.shapes.begin(), m.shapes.end(),
            [](const cases::CaseShape& a, const cases::CaseShape& b) { return a.number < b.number; });
  return out;
}

}  // namespace trephine::publish
