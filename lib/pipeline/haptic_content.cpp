// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/haptic_content.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "meshing/contour.h"
#include "pipeline/figures.h"
#include "voxel/decode.h"
#include "voxel/haptic_file.h"

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
    s.cuttable = wanted.cuttable;
    s.volume_ml = number_in(made, shape.name + ".volume_ml");
    const bool seen = std::any_of(config.scene.begin(), config.scene.end(),
                                  [&](const SceneAnatomy& a) { return a.name == shape.name; });
    s.displayed = seen ? "surface" : "haptic";
    if (seen) {
      const std::string prefix = shape.name + ".mismatch_";
      s.mismatch = {number_in(mismatch, prefix + "bias_mm"),
                    number_in(mismatch, prefix + "rms_mm"),
                    number_in(mismatch, prefix + "p99_mm"),
                    number_in(mismatch, prefix + "max_mm"),
                    number_in(mismatch, prefix + "missed_ratio"),
                    static_cast<std::uint64_t>(number_in(mismatch, prefix + "samples_count"))};
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

bool hole_is_free(const HapticVolume& volume, const std::string& shape, const Cutter& cylinder) {
  const HapticDecoder decoder(volume);
  const int number = volume.find_shape(shape)->number;
  const Vec3 spacing = volume.voxels.spacing_mm;
  const double step_mm = std::min({spacing.x, spacing.y, spacing.z}) / 2, radius_mm = cylinder.radius_mm - hole_play_mm;
  if (radius_mm <= 0) return true;
  const Vec3 u =
      normalized(cross(cylinder.direction, std::abs(cylinder.direction.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}));
  const Vec3 v = cross(cylinder.direction, u);
  const int around = std::max(8, static_cast<int>(std::ceil(2 * 3.14159265358979 * radius_mm / step_mm)));
  // The ends of the cylinder are as far from what it leaves as its side is.
  for (double t = -cylinder.above_mm + hole_play_mm; t <= cylinder.depth_mm - hole_play_mm; t += step_mm)
    for (int ring = 0; ring <= 4; ++ring)
      for (int i = 0; i < around; ++i) {
        const double angle = 2 * 3.14159265358979 * i / around, r = radius_mm * ring / 4;
        const Vec3 p =
            cylinder.position_mm + cylinder.direction * t + u * (r * std::cos(angle)) + v * (r * std::sin(angle));
        if (decoder.trilinear(number, p) >= 0.5) return false;
      }
  return true;
}

TriMesh surface_of_shape(const HapticVolume& volume, int number, const Progress& progress) {
  const HapticDecoder decoder(volume);
  Field field(static_cast<const Lattice&>(volume.voxels));
  parallel_for(0, field.size[2], 1, [&](std::int64_t from, std::int64_t to) {
    for (int k = static_cast<int>(from); k < static_cast<int>(to); ++k)
      for (int j = 0; j < field.size[1]; ++j)
        for (int i = 0; i < field.size[0]; ++i)
          field.at(i, j, k) = static_cast<float>(decoder.occupancy(number, i, j, k) - 0.5);
  });
  Report ignored;
  ContourParams params;
  params.min_component_mm3 = 0;
  params.keep_cavities = true;
  return contour(field, params, ignored, progress);
}

}  // namespace trephine
