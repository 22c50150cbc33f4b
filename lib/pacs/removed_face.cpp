// SPDX-License-Identifier: GPL-3.0-or-later
#include "pacs/removed_face.h"

#include <algorithm>
#include <cmath>

#include "dicom/hu.h"

namespace trephine::pacs {
namespace {

constexpr int pixels_mixed = 2, slices_mixed = 2;

bool are_own_voxels(const grid::Lattice& ct, const SliceSet& s) {
  constexpr double tolerance = 1e-3;
  const auto near = [&](double a, double b) { return std::abs(a - b) <= tolerance; };
  if (!near(s.dx_mm, ct.spacing_mm.x) || !near(s.dy_mm, ct.spacing_mm.y)) return false;
  if (norm(s.u - ct.direction.column[0]) > tolerance || norm(s.v - ct.direction.column[1]) > tolerance) return false;
  Vec3 before;
  for (std::size_t k = 0; k < s.origins_mm.size(); ++k) {
    const Vec3 at = ct.to_index(s.origins_mm[k]);
    for (int a = 0; a < 3; ++a)
      if (!near(at[a], std::round(at[a]))) return false;
    if (k > 0 && !(near(at.x, before.x) && near(at.y, before.y) && near(at.z, before.z + 1))) return false;
    before = at;
  }
  return true;
}

// Along one axis: 1 where all voxels of the lattice within the reach are set, or where any is.
void filter(grid::Mask& mask, int axis, int reach, bool any) {
  const auto& n = mask.size;
  const int length = n[axis];
  const std::size_t step = axis == 0 ? 1 : axis == 1 ? std::size_t(n[0]) : std::size_t(n[0]) * std::size_t(n[1]);
  const int b = axis == 0 ? 1 : 0, c = axis == 2 ? 1 : 2;
  std::vector<int> sums(std::size_t(length) + 1);
  for (int q = 0; q < n[c]; ++q)
    for (int p = 0; p < n[b]; ++p) {
      int at[3];
      at[axis] = 0;
      at[b] = p;
      at[c] = q;
      std::uint8_t* first = &mask.voxels[mask.index(at[0], at[1], at[2])];
      sums[0] = 0;
      for (int i = 0; i < length; ++i) sums[std::size_t(i) + 1] = sums[std::size_t(i)] + first[std::size_t(i) * step];
      for (int i = 0; i < length; ++i) {
        const int from = std::max(0, i - reach), to = std::min(length, i + reach + 1);
        const int count = sums[std::size_t(to)] - sums[std::size_t(from)];
        first[std::size_t(i) * step] = any ? count > 0 : count == to - from;
      }
    }
}

double largest_step_mm(const SliceSet& s) {
  double most = s.thickness_mm;
  for (std::size_t k = 1; k < s.origins_mm.size(); ++k)
    most = std::max(most, dot(s.origins_mm[k] - s.origins_mm[k - 1], s.normal()));
  return most;
}

}  // namespace

grid::Grid<std::int16_t> with_room_around_removed(const grid::Grid<std::int16_t>& ct, const SliceSet& slices,
                                                  const Progress& progress) {
  grid::Grid<std::int16_t> out = ct;
  if (are_own_voxels(ct, slices)) return out;
  constexpr auto removed = static_cast<std::int16_t>(dicom::air_hu);
  grid::Mask mask(static_cast<const grid::Lattice&>(ct));
  for (std::size_t i = 0; i < ct.voxels.size(); ++i) mask.voxels[i] = ct.voxels[i] == removed;
  for (int a = 0; a < 3; ++a) filter(mask, a, 1, false);
  const Vec3 reach_mm{pixels_mixed * slices.dx_mm, pixels_mixed * slices.dy_mm, slices_mixed * largest_step_mm(slices)};
  const Vec3 axes[3] = {slices.u, slices.v, slices.normal()};
  for (int a = 0; a < 3; ++a) {
    progress.check();
    double mm = 0;
    for (int b = 0; b < 3; ++b) mm += std::abs(dot(ct.direction.column[a], axes[b])) * reach_mm[b];
    filter(mask, a, int(std::ceil(mm / ct.spacing_mm[a] - 1e-9)) + 1, true);  // 1: what the other filter took
  }
  for (std::size_t i = 0; i < ct.voxels.size(); ++i)
    if (mask.voxels[i]) out.voxels[i] = removed;
  return out;
}

}  // namespace trephine::pacs
