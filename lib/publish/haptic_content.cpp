// SPDX-License-Identifier: GPL-3.0-or-later
#include "publish/haptic_content.h"

#include <algorithm>

#include "surface/results.h"
#include "voxel/haptic_file.h"
#include "voxel/mismatch.h"

namespace trephine {
HapticContent make_haptic_content(const CaseConfig& config, const HapticVolume& volume, const Report& made,
                                  const Report& mismatch) {
  HapticContent out;
  out.bytes = encode_haptic(volume);
  if (!volume.hardness.voxels.empty()) out.hardness_bytes = encode_hardness(volume);
  CaseHaptic& m = out.manifest;
  m.encoding = volume.encoding == HapticEncoding::hu ? "hu" : "occupancy";
  m.size = volume.voxels.size;
  m.spacing_mm = volume.voxels.spacing_mm;
  for (const SceneShape& wanted : config.haptic.shapes) {
    const HapticShape& shape = *volume.find_shape(wanted.name);
    CaseShape s;
    s.name = shape.name;
    s.number = shape.number;
    s.window_low = shape.window_low;
    s.window_high = shape.window_high;
    s.material = wanted.material;
    static_cast<ShapeParams&>(s) = wanted;
    s.volume_ml = result_of<ShapeVolumeResult>(made, shape.name + ".").volume_ml;
    const bool seen = std::any_of(config.scene.begin(), config.scene.end(),
                                  [&](const SceneAnatomy& a) { return a.name == shape.name; });
    s.displayed = seen ? "surface" : "haptic";
    if (seen) {
      const auto m = result_of<Mismatch>(mismatch, shape.name + ".");
      s.mismatch = {m.bias_mm, m.rms_mm, m.p99_mm, m.max_mm, m.missed_ratio, m.samples};
    } else {
      CaseAnatomy a;
      a.name = shape.name;
      a.colour_rgb = wanted.material.colour_rgb;
      a.volume_ml = s.volume_ml;
      out.anatomies.push_back(std::move(a));
    }
    m.shapes.push_back(std::move(s));
  }
  std::sort(m.shapes.begin(), m.shapes.end(),
            [](const CaseShape& a, const CaseShape& b) { return a.number < b.number; });
  return out;
}

}  // namespace trephine
