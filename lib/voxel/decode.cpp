// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxel/decode.h"

#include <algorithm>
#include <cmath>

#include "voxel/raw_voxel.h"

namespace trephine::voxel {
namespace {

constexpr int air_hu = -1000;

// The cell whose corner is the voxel below the point, and where in it; false where no voxel of the lattice is near.
bool find_cell(const grid::Lattice& lattice, Vec3 index, int* begin, double* fraction) {
  for (int a = 0; a < 3; ++a) {
    const double x = index[a];
    if (!(x > -1 && x < lattice.size[std::size_t(a)])) return false;  // false for NaN, too
    const double below = std::floor(x);
    begin[a] = int(below);
    fraction[a] = x - below;
  }
  return true;
}

// Calls each(weight, i, j, k) for the corners of the cell that lie on the lattice and have weight.
template <class Each>
void for_each_corner(const grid::Lattice& lattice, const int* begin, const double* f, const Each& each) {
  for (int c = 0; c < 8; ++c) {
    const int i = begin[0] + (c & 1), j = begin[1] + (c >> 1 & 1), k = begin[2] + (c >> 2);
    const double w = (c & 1 ? f[0] : 1 - f[0]) * (c & 2 ? f[1] : 1 - f[1]) * (c & 4 ? f[2] : 1 - f[2]);
    if (w > 0) each(w, i, j, k, lattice.contains(i, j, k));
  }
}

}  // namespace

double hu_occupancy(double hu, int low) {
  const double half = std::max(1, low - air_hu);
  return std::clamp(0.5 + (hu - low) / (2 * half), 0.0, 1.0);
}

HapticDecoder::HapticDecoder(const HapticVolume& volume) : volume_(volume) {
  const std::array<int, haptic_max_shapes + 1> group = adjoining_windows(volume.shapes);
  for (const HapticShape& s : volume.shapes) {
    if (window_count_ == haptic_max_shapes || s.number < 1 || s.number > haptic_max_shapes) continue;
    const Window w{s.number, s.window_low, s.window_high, group[std::size_t(s.number)]};
    lowest_ = window_count_ == 0 ? w.low : std::min(lowest_, w.low);
    windows_[std::size_t(window_count_++)] = w;
    by_number_[std::size_t(s.number)] = w;
  }
}

const HapticDecoder::Window& HapticDecoder::window_of(int number) const {
  return by_number_[number >= 1 && number <= haptic_max_shapes ? std::size_t(number) : 0];
}

int HapticDecoder::shape_at(int i, int j, int k) const {
  if (!volume_.voxels.contains(i, j, k)) return 0;
  const int value = detail::load_voxel(volume_.voxels.voxels[volume_.voxels.index(i, j, k)]);
  if (volume_.encoding == HapticEncoding::occupancy) {
    const int number = detail::split(std::int16_t(value)).number;
    return window_of(number).number;
  }
  for (int n = 0; n < window_count_; ++n)
    if (value >= windows_[std::size_t(n)].low && value <= windows_[std::size_t(n)].high)
      return windows_[std::size_t(n)].number;
  return 0;
}

double HapticDecoder::occupancy(int number, int i, int j, int k) const {
  const Window& w = window_of(number);
  if (w.number == 0 || !volume_.voxels.contains(i, j, k)) return 0;
  if (volume_.encoding == HapticEncoding::occupancy)
    return detail::share_of(volume_.voxels, number, i, j, k) / double(haptic_full);
  const int hu = detail::load_voxel(volume_.voxels.voxels[volume_.voxels.index(i, j, k)]);
  return (hu >= w.low && hu <= w.high) || hu < lowest_ ? hu_occupancy(hu, w.low) : 0;
}

double HapticDecoder::nearest(int number, Vec3 world_mm) const {
  const Vec3 index = volume_.voxels.to_index(world_mm);
  int voxel[3];
  for (int a = 0; a < 3; ++a) {
    const double x = std::floor(index[a] + 0.5);
    if (!(x >= 0 && x < volume_.voxels.size[std::size_t(a)])) return 0;
    voxel[a] = int(x);
  }
  return occupancy(number, voxel[0], voxel[1], voxel[2]);
}

double HapticDecoder::trilinear(int number, Vec3 world_mm) const {
  return trilinear_at(number, volume_.voxels.to_index(world_mm));
}

double HapticDecoder::trilinear_at(int number, Vec3 index) const {
  const Window& window = window_of(number);
  int begin[3];
  double fraction[3];
  if (window.number == 0 || !find_cell(volume_.voxels, index, begin, fraction)) return 0;
  if (volume_.encoding == HapticEncoding::hu) return trilinear_hu(window, begin, fraction);
  double sum = 0;
  for_each_corner(volume_.voxels, begin, fraction, [&](double w, int i, int j, int k, bool within) {
    if (within) sum += w * detail::share_of(volume_.voxels, number, i, j, k);
  });
  return std::min(1.0, sum / haptic_full);
}

double HapticDecoder::trilinear_hu(const Window& window, const int* begin, const double* fraction) const {
  double top = window.high + 0.5;  // towards HU of no window; towards one that adjoins, where that begins
  bool meets = false;
  const auto hu_at = [&](int i, int j, int k, bool within) {
    return within ? int(detail::load_voxel(volume_.voxels.voxels[volume_.voxels.index(i, j, k)])) : haptic_beyond_hu;
  };
  for_each_corner(volume_.voxels, begin, fraction, [&](double, int i, int j, int k, bool within) {
    const int hu = hu_at(i, j, k, within);
    for (int n = 0; n < window_count_ && hu > window.high; ++n) {
      const Window& other = windows_[std::size_t(n)];
      if (hu < other.low || hu > other.high || other.group != window.group) continue;
      top = meets ? std::min(top, double(other.low)) : other.low;
      meets = true;
    }
  });
  double above_low = 0, below_top = 0;
  for_each_corner(volume_.voxels, begin, fraction, [&](double w, int i, int j, int k, bool within) {
    const int hu = hu_at(i, j, k, within);
    if (hu <= window.high) above_low += w * (hu - window.low);
    if (hu > window.high) below_top += w * std::min(top - hu, -0.5);
    if (hu >= window.low && hu <= window.high) below_top += w * (top - hu);
  });
  return hu_occupancy(std::min(above_low, below_top) + window.low, window.low);
}

Vec3 HapticDecoder::gradient(int number, Vec3 world_mm) const {
  const Vec3 index = volume_.voxels.to_index(world_mm);
  Vec3 along;
  for (int a = 0; a < 3; ++a) {
    Vec3 before = index, after = index;
    before[a] -= 1;
    after[a] += 1;
    along[a] = (trilinear_at(number, after) - trilinear_at(number, before)) / (2 * volume_.voxels.spacing_mm[a]);
  }
  return is_finite(along) ? volume_.voxels.direction * along : Vec3{};
}

}  // namespace trephine::voxel
