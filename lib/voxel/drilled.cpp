// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxel/drilled.h"

#include "base/error.h"
#include "base/parallel.h"
#include "voxel/decode.h"

namespace trephine::voxel {
namespace {

// Calls f with the index of each neighbour; of 6 or of 26.
template <class F>
void for_neighbours(const grid::Lattice& l, int i, int j, int k, bool faces_alone, F f) {
  for (int d = 0; d < 27; ++d) {
    const int a = d % 3 - 1, b = d / 3 % 3 - 1, c = d / 9 - 1;
    const int away = a * a + b * b + c * c;
    if (away == 0 || (faces_alone && away > 1) || !l.contains(i + a, j + b, k + c)) continue;
    f(l.index(i + a, j + b, k + c));
  }
}

// Beside what was removed: a remainder with nothing left to hold it, and a share that was the removed shape's.
void clear_beside(const HapticVolume& before, const grid::Mask& removed, HapticVolume& out) {
  const grid::Lattice& l = before.voxels;
  const grid::Mask shown = shown_shapes(before);
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i) {
        const std::size_t at = l.index(i, j, k);
        const std::int16_t raw = before.voxels.voxels[at];
        if (removed.voxels[at] || raw == haptic_empty) continue;
        bool beside = false, held = false;
        for_neighbours(l, i, j, k, false, [&](std::size_t n) { beside = beside || removed.voxels[n]; });
        if (!beside) continue;
        for_neighbours(l, i, j, k, true,
                       [&](std::size_t n) { held = held || (!removed.voxels[n] && shown.voxels[n]); });
        if (!shown.voxels[at] && !held)
          out.voxels.voxels[at] = haptic_empty;
        else if (raw % haptic_base_step <= haptic_full)
          out.voxels.voxels[at] = std::int16_t(raw + haptic_bare_offset);
      }
}

}  // namespace

grid::Mask shown_shapes(const HapticVolume& volume) {
  const grid::Lattice& l = volume.voxels;
  grid::Mask shown(l);
  const HapticDecoder decoder(volume);
  parallel_for(0, l.size[2], 1, [&](std::int64_t k, std::int64_t) {
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i) {
        double all = 0, most = 0;
        int which = 0;
        for (const HapticShape& s : volume.shapes) {
          const double o = decoder.occupancy(s.number, i, j, int(k));
          all += o;
          if (o > most) most = o, which = s.number;
        }
        // Below a window of HU each other one adds a part of itself again.
        if ((volume.encoding == HapticEncoding::hu ? most : all) >= 0.5) shown.at(i, j, int(k)) = std::uint8_t(which);
      }
  });
  return shown;
}

HapticVolume drilled_volume(const HapticVolume& volume, const grid::Mask& removed) {
  if (static_cast<const grid::Lattice&>(volume.voxels) != static_cast<const grid::Lattice&>(removed))
    throw Error(ExitCode::internal, "", "removed", "lies on another lattice than the volume");
  HapticVolume out = volume;
  const std::int16_t empty =
      volume.encoding == HapticEncoding::hu ? std::int16_t(haptic_beyond_hu) : std::int16_t(haptic_empty);
  for (std::size_t i = 0; i < removed.voxels.size(); ++i)
    if (removed.voxels[i]) out.voxels.voxels[i] = empty;
  if (volume.encoding == HapticEncoding::occupancy) clear_beside(volume, removed, out);
  return out;
}

}  // namespace trephine::voxel
