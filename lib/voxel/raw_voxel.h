// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Raw values of encoding `occupancy`, for the sources of this room. Nothing here allocates or throws.
#include <algorithm>
#include <array>
#include <cstdint>

#include "grid/grid.h"
#include "voxel/haptic_volume.h"

namespace trephine::voxel::detail {

/// Reads a voxel's raw value in a way that is safe while another thread drills.
inline std::int16_t load_voxel(const std::int16_t& voxel) { return __atomic_load_n(&voxel, __ATOMIC_RELAXED); }

/// Replaces a voxel's raw value by what `change` makes of it, again where another thread changed it meanwhile: so
/// nobody's older value comes back.
template <class Change>
void change_voxel(std::int16_t& voxel, const Change& change) {
  std::int16_t was = load_voxel(voxel), now;
  do {
    now = change(was);
    if (now == was) return;
  } while (!__atomic_compare_exchange_n(&voxel, &was, now, true, __ATOMIC_RELAXED, __ATOMIC_RELAXED));
}

/// A copy of the box, voxel by voxel, while another thread drills.
inline grid::Grid<std::int16_t> copy_voxels(const grid::Grid<std::int16_t>& voxels, const grid::Box& box) {
  grid::Grid<std::int16_t> out(grid::cropped(voxels, box));
  std::int16_t* to = out.voxels.data();
  for (int k = box.begin[2]; k < box.end[2]; ++k)
    for (int j = box.begin[1]; j < box.end[1]; ++j) {
      const std::int16_t* row = voxels.voxels.data() + voxels.index(0, j, k);
      for (int i = box.begin[0]; i < box.end[0]; ++i) *to++ = load_voxel(row[i]);
    }
  return out;
}

struct RawVoxel {
  int number = 0;     ///< 0: EMPTY, or the value of no shape
  int share = 0;      ///< 1 to 255 where number > 0
  bool bare = false;  ///< the rest is EMPTY
};

inline RawVoxel split(std::int16_t value) {
  if (value <= haptic_base_step) return {};
  const int number = value / haptic_base_step, o = value % haptic_base_step;
  if (number > haptic_max_shapes) return {};
  if (o >= 1 && o <= haptic_full) return {number, o, false};
  if (o > haptic_bare_offset && o <= haptic_bare_offset + haptic_full) return {number, o - haptic_bare_offset, true};
  return {};
}

inline std::int16_t join(int number, int share, bool bare) {
  return static_cast<std::int16_t>(haptic_base_step * number + share + (bare ? haptic_bare_offset : 0));
}

/// Calls look(RawVoxel) for the 26 neighbours that are of another shape than `own` and not empty, until it returns
/// true; returns whether it did.
template <class Look>
bool any_other_neighbour(const grid::Grid<std::int16_t>& voxels, int own, int i, int j, int k, const Look& look) {
  const int own_base = haptic_base_step * own;
  const int i0 = std::max(0, i - 1), i1 = std::min(voxels.size[0] - 1, i + 1);
  const int j0 = std::max(0, j - 1), j1 = std::min(voxels.size[1] - 1, j + 1);
  const int k0 = std::max(0, k - 1), k1 = std::min(voxels.size[2] - 1, k + 1);
  for (int z = k0; z <= k1; ++z)
    for (int y = j0; y <= j1; ++y) {
      const std::int16_t* row = voxels.voxels.data() + voxels.index(0, y, z);
      for (int x = i0; x <= i1; ++x) {
        const int raw = load_voxel(row[x]);
        if (raw == haptic_empty || unsigned(raw - own_base) < unsigned(haptic_base_step)) continue;
        const RawVoxel v = split(std::int16_t(raw));
        if (v.number != 0 && look(v)) return true;
      }
    }
  return false;
}

/// The shape to which the rest of a voxel of shape `own` belongs: another shape, whose voxels among the 26 neighbours
/// add up to the largest occupancy (of equals the lower number); 0 where there is none.
inline int other_shape(const grid::Grid<std::int16_t>& voxels, int own, int i, int j, int k) {
  // In most places one other shape or none is near; the table serves the others.
  int only = 0, sum_of_only = 0;
  std::array<int, haptic_max_shapes + 1> sums;
  bool several = false;
  any_other_neighbour(voxels, own, i, j, k, [&](const RawVoxel& v) {
    if (!several) {
      if (only == 0 || only == v.number) {
        only = v.number;
        sum_of_only += v.share;
        return false;
      }
      several = true;
      sums.fill(0);
      sums[std::size_t(only)] = sum_of_only;
    }
    sums[std::size_t(v.number)] += v.share;
    return false;
  });
  if (!several) return only;
  return int(std::max_element(sums.begin(), sums.end()) - sums.begin());
}

/// Whether other_shape is not 0, which is sooner known than what it is.
inline bool beside_other_shape(const grid::Grid<std::int16_t>& voxels, int own, int i, int j, int k) {
  return any_other_neighbour(voxels, own, i, j, k, [](const RawVoxel&) { return true; });
}

/// The share (of 255) of shape `number` in the voxel.
inline int share_of(const grid::Grid<std::int16_t>& voxels, int number, int i, int j, int k) {
  const RawVoxel v = split(load_voxel(voxels.voxels[voxels.index(i, j, k)]));
  if (v.number == 0) return 0;
  if (v.number == number) return v.share;
  if (v.bare || v.share == haptic_full) return 0;
  return other_shape(voxels, v.number, i, j, k) == number ? haptic_full - v.share : 0;
}

}  // namespace trephine::voxel::detail
