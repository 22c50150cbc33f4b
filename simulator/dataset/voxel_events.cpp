// SPDX-License-Identifier: GPL-3.0-or-later
#include "dataset/voxel_events.h"

#include "voxel/raw_voxel.h"

namespace trephine::dataset {
namespace {

// The shape that fills at least half of a voxel of that value; 0 for none.
int filled_by(const voxel::HapticVolume& volume, std::int16_t raw) {
  if (volume.encoding == voxel::HapticEncoding::occupancy) {
    const voxel::detail::RawVoxel v = voxel::detail::split(raw);
    return 2 * v.share > voxel::haptic_full ? v.number : 0;
  }
  for (const voxel::HapticShape& s : volume.shapes)
    if (raw >= s.window_low && raw <= s.window_high) return s.number;
  return 0;
}

}  // namespace

VoxelEvents voxel_events(const voxel::HapticVolume& volume, const std::vector<session::Playback::VoxelChange>& changes,
                         VoxelEvent which) {
  VoxelEvents out;
  const std::size_t row = std::size_t(volume.voxels.size[0]), rows = std::size_t(volume.voxels.size[1]);
  for (const session::Playback::VoxelChange& c : changes) {
    const int before = filled_by(volume, c.before), after = filled_by(volume, c.after);
    const int shape = which == VoxelEvent::removed ? before : after;
    if (before == after || shape == 0) continue;
    if (out.time_s.empty() || out.time_s.back() != c.time_s) out.time_s.push_back(c.time_s);
    const std::array<int, 3> at{int(c.at % row), int(c.at / row % rows), int(c.at / row / rows)};
    out.voxels.push_back({out.time_s.size() - 1, at, shape});
  }
  return out;
}

}  // namespace trephine::dataset
