// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/voxel_table.h"

#include <algorithm>
#include <limits>

#include "voxel/raw_voxel.h"

namespace trephine::contact {

VoxelTable::VoxelTable(const voxel::HapticVolume& volume) : entries_(65536, 0) {
  if (volume.encoding == voxel::HapticEncoding::hu)
    add_windows(volume.shapes);
  else
    add_shares(volume.shapes);
}

void VoxelTable::add_windows(const std::vector<voxel::HapticShape>& shapes) {
  group_ = voxel::adjoining_windows(shapes);
  int lowest = std::numeric_limits<int>::max();
  for (const voxel::HapticShape& s : shapes) lowest = std::min<int>(lowest, s.window_low);
  for (int raw = -32768; raw <= 32767; ++raw) entries_[std::uint16_t(raw)] = raw < lowest ? 0 : contact_gap;
  for (const voxel::HapticShape& s : shapes) {
    low_of_[std::size_t(s.number)] = s.window_low;
    high_of_[std::size_t(s.number)] = s.window_high;
    for (int raw = s.window_low; raw <= s.window_high; ++raw)
      entries_[std::uint16_t(raw)] = std::uint32_t(voxel::haptic_full << 8 | contact_pure | s.number);
  }
}

void VoxelTable::add_shares(const std::vector<voxel::HapticShape>& shapes) {
  for (const voxel::HapticShape& s : shapes)
    for (int raw = s.window_low; raw <= s.window_high; ++raw) {
      const voxel::detail::RawVoxel v = voxel::detail::split(std::int16_t(raw));
      if (v.number != s.number) continue;
      const int rest = v.bare ? 0 : voxel::haptic_full - v.share,
                pure = v.share == voxel::haptic_full ? contact_pure : 0;
      entries_[std::uint16_t(raw)] = std::uint32_t(rest) << 24 | std::uint32_t(v.share) << 16 |
                                     std::uint32_t(v.share + rest) << 8 | std::uint32_t(pure | v.number);
    }
}

}  // namespace trephine::contact
