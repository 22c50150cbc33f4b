// SPDX-License-Identifier: GPL-3.0-or-later
#include "cast/cast_table.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "base/parallel.h"
#include "base/srgb.h"
#include "cast/cast_shapes.h"

namespace trephine::cast {

CastTable::CastTable(const std::vector<voxel::TransferFunction>& functions) {
  for (int n = 0; n < count; ++n) {
    double clear = 1, sum = 0;
    std::array<double, 3> colour{0, 0, 0};
    for (const voxel::TransferFunction& f : functions) {
      const voxel::TransferPoint p = voxel::at_hu(f, low_hu + n);
      clear *= 1 - p.opacity;
      sum += p.opacity;
      for (std::size_t c = 0; c < 3; ++c) colour[c] += p.opacity * linear_of_srgb(p.colour_rgb[c]);
    }
    Entry& e = entries_[std::size_t(n)];
    for (std::size_t c = 0; c < 3; ++c) e[c] = sum > 0 ? float(colour[c] / sum) : 0;
    e[3] = float(1 - clear);
    seen_below_[std::size_t(n) + 1] = seen_below_[std::size_t(n)] + (e[3] > 0);
  }
  // The colour of what is clear counts where it is mixed with its neighbour's.
  for (int n = 1; n < count; ++n)
    if (entries_[std::size_t(n)][3] == 0 && entries_[std::size_t(n - 1)][3] > 0)
      std::copy_n(entries_[std::size_t(n - 1)].begin(), 3, entries_[std::size_t(n)].begin());
  for (int n = count - 1; n-- > 0;)
    if (entries_[std::size_t(n)][3] == 0 && entries_[std::size_t(n + 1)][3] > 0)
      std::copy_n(entries_[std::size_t(n + 1)].begin(), 3, entries_[std::size_t(n)].begin());
}

CastTable::Entry CastTable::at(double hu) const {
  const double x = std::clamp(hu - low_hu, 0.0, double(count - 1));
  const int n = std::min(int(x), count - 2);
  const float t = float(x - n);
  const Entry &a = entries_[std::size_t(n)], &b = entries_[std::size_t(n) + 1];
  Entry e;
  for (std::size_t c = 0; c < 4; ++c) e[c] = a[c] + t * (b[c] - a[c]);
  return e;
}

std::array<int, 2> CastTable::seen_hu() const {
  int first = 0, last = count - 1;
  while (first < count && !(entries_[std::size_t(first)][3] > 0)) ++first;
  while (last >= 0 && !(entries_[std::size_t(last)][3] > 0)) --last;
  // Between an entry that is clear and its neighbour that is not, something is seen.
  return {first > 0 ? low_hu + first - 1 : -32768, last < count - 1 ? low_hu + last + 1 : 32767};
}

bool CastTable::sees(int from_hu, int to_hu) const {
  const int from = std::clamp(from_hu - low_hu, 0, count - 1), to = std::clamp(to_hu - low_hu, 0, count - 1);
  return seen_below_[std::size_t(to) + 1] > seen_below_[std::size_t(from)];
}

std::vector<voxel::TransferFunction> functions_of(const cases::CaseHaptic& haptic) {
  std::vector<voxel::TransferFunction> all;
  for (const cases::CaseShape& s : haptic.shapes)
    all.push_back(s.transfer ? voxel::resolved(*s.transfer)
                             : voxel::window_function(s.window_low, s.window_high, s.material.colour_rgb));
  return all;
}

void CastBricks::begin(const grid::Lattice& lattice) {
  for (std::size_t a = 0; a < 3; ++a) size[a] = (lattice.size[a] + side - 1) / side;
  clear.assign(std::size_t(size[0]) * std::size_t(size[1]) * std::size_t(size[2]), 1);
}

CastBricks::CastBricks(const grid::Grid<std::int16_t>& voxels, const CastTable& table) {
  begin(voxels);
  range_hu.resize(clear.size());
  look(voxels, table, grid::whole_box(voxels));
  find_distances();
}

CastBricks::CastBricks(const CastShapes& shapes) {
  begin(shapes.voxels());
  look(shapes, grid::whole_box(shapes.voxels()));
  find_distances();
}

void CastBricks::look(const CastTable& table) {
  for (std::size_t n = 0; n < clear.size(); ++n) clear[n] = table.sees(range_hu[n][0], range_hu[n][1]) ? 0 : 1;
  find_distances();
}

// Whether a brick shows something says shows(its number, its first voxel, its last).
template <class Shows>
void CastBricks::look_again(const grid::Lattice& lattice, const grid::Box& box, const Shows& shows) {
  std::array<int, 3> first, last;
  for (std::size_t a = 0; a < 3; ++a) {
    first[a] = std::max(0, (box.begin[a] - 1) / side);
    last[a] = std::min(size[a] - 1, (box.end[a] - 1) / side);
  }
  std::atomic<bool> comes{false};  // something that was clear
  parallel_for(first[2], last[2] + 1, 1, [&](std::int64_t z, std::int64_t) {
    for (int y = first[1]; y <= last[1]; ++y)
      for (int x = first[0]; x <= last[0]; ++x) {
        const std::array<int, 3> at{x * side, y * side, int(z) * side};
        std::array<int, 3> end;
        for (std::size_t a = 0; a < 3; ++a) end[a] = std::min(at[a] + side, lattice.size[a] - 1);
        const std::size_t n = index(x, y, int(z));
        std::uint8_t& is = clear[n];
        const bool seen = shows(n, at, end);
        if (seen && is != 0) comes = true;
        is = seen ? 0 : std::max<std::uint8_t>(is, 1);
      }
  });
  if (comes) find_distances();
}

void CastBricks::look(const grid::Grid<std::int16_t>& voxels, const CastTable& table, const grid::Box& box) {
  look_again(voxels, box, [&](std::size_t n, const std::array<int, 3>& at, const std::array<int, 3>& end) {
    int least = 32767, most = -32768;
    for (int k = at[2]; k <= end[2]; ++k)
      for (int j = at[1]; j <= end[1]; ++j)
        for (int i = at[0]; i <= end[0]; ++i) {
          // A servo loop may be cutting.
          const int hu = __atomic_load_n(&voxels.voxels[voxels.index(i, j, k)], __ATOMIC_RELAXED);
          least = std::min(least, hu);
          most = std::max(most, hu);
        }
    range_hu[n] = {std::int16_t(least), std::int16_t(most)};
    return table.sees(least, most);
  });
}

void CastBricks::look(const CastShapes& shapes, const grid::Box& box) {
  const grid::Grid<CastShapes::Voxel>& v = shapes.voxels();
  look_again(v, box, [&](std::size_t, const std::array<int, 3>& at, const std::array<int, 3>& end) {
    for (int k = at[2]; k <= end[2]; ++k)
      for (int j = at[1]; j <= end[1]; ++j)
        for (int i = at[0]; i <= end[0]; ++i)
          if (shapes.sees(v.at(i, j, k))) return true;
    return false;
  });
}

// The chessboard distance to what is shown, in two passes over the 26 neighbours; beyond the volume nothing is.
void CastBricks::find_distances() {
  constexpr int most = 255;
  for (std::uint8_t& c : clear) c = c ? most : 0;
  const auto pass = [&](int step) {
    const auto from = [&](int a) { return step > 0 ? 0 : size[std::size_t(a)] - 1; };
    const auto in = [&](int n, int a) { return n >= 0 && n < size[std::size_t(a)]; };
    for (int k = from(2); in(k, 2); k += step)
      for (int j = from(1); in(j, 1); j += step)
        for (int i = from(0); in(i, 0); i += step) {
          std::uint8_t& is = clear[index(i, j, k)];
          if (is == 0) continue;
          // Those that the pass has been at: of the plane before, of the row before, and the one before.
          const auto meet = [&](int x, int y, int z) {
            if (in(x, 0) && in(y, 1) && in(z, 2)) is = std::uint8_t(std::min<int>(is, clear[index(x, y, z)] + 1));
          };
          for (int y = j - 1; y <= j + 1; ++y)
            for (int x = i - 1; x <= i + 1; ++x) meet(x, y, k - step);
          for (int x = i - 1; x <= i + 1; ++x) meet(x, j - step, k);
          meet(i - step, j, k);
        }
  };
  pass(1);
  pass(-1);
}

}  // namespace trephine::cast
