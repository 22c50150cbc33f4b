// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <optional>

#include "base/parallel.h"
#include "grid/resample.h"
#include "grid/sample.h"
#include "page/pack.h"
#include "voxel/decode.h"
#include "voxel/voxel_shapes.h"

namespace trephine::page {
namespace {

constexpr double along_axis = 1 - 1e-6;  // of a direction: it does not lie oblique

// The patient's axis along which axis k of the lattice runs; nothing where it lies oblique.
std::optional<int> patient_axis(const grid::Lattice& lattice, int k) {
  for (int axis = 0; axis < 3; ++axis)
    if (std::abs(lattice.direction.column[k][axis]) >= along_axis) return axis;
  return {};
}

// The lattice along the patient's axes for a volume: its own voxels where it lies along them, else the box around it
// with at most `side` voxels a side.
grid::Lattice page_lattice(const grid::Lattice& from, int side) {
  Vec3 least{1e300, 1e300, 1e300}, most{-1e300, -1e300, -1e300};
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 at = from.to_world_mm({corner & 1 ? from.size[0] - 1.0 : 0.0, corner & 2 ? from.size[1] - 1.0 : 0.0,
                                      corner & 4 ? from.size[2] - 1.0 : 0.0});
    for (int k = 0; k < 3; ++k) {
      least[k] = std::min(least[k], at[k]);
      most[k] = std::max(most[k], at[k]);
    }
  }
  const double finest = std::min({from.spacing_mm.x, from.spacing_mm.y, from.spacing_mm.z});
  grid::Lattice to;
  to.origin_mm = least;
  for (int axis = 0; axis < 3; ++axis) {
    const double length = most[axis] - least[axis];
    to.size[axis] = std::clamp(static_cast<int>(std::ceil(length / finest - 1e-6)) + 1, 1, side);
    to.spacing_mm[axis] = to.size[axis] > 1 ? length / (to.size[axis] - 1) : finest;
  }
  bool straight = true;
  for (int k = 0; k < 3; ++k) straight &= patient_axis(from, k).has_value();
  for (int k = 0; straight && k < 3; ++k) {
    const int axis = *patient_axis(from, k);
    to.size[axis] = from.size[k];
    to.spacing_mm[axis] = from.spacing_mm[k];
  }
  return to;
}

// The voxel sizes with as many voxels as a page takes, each the mean of those that it covers; empty: the scan's own.
std::optional<std::array<double, 3>> larger_voxels_mm(const grid::Lattice& lattice, int side) {
  std::array<double, 3> step_mm{};
  bool larger = false;
  for (int k = 0; k < 3; ++k) {
    const bool is_large = lattice.size[k] > side;
    step_mm[std::size_t(k)] = is_large ? lattice.spacing_mm[k] * lattice.size[k] / side : lattice.spacing_mm[k];
    larger |= is_large;
  }
  return larger ? std::optional(step_mm) : std::nullopt;
}

std::uint8_t level_of(double hu) {
  const auto& levels = page_hu_levels;
  if (!(hu > levels.front()[1])) return 0;
  for (std::size_t i = 1; i < levels.size(); ++i)
    if (hu < levels[i][1]) {
      const double share = (hu - levels[i - 1][1]) / (levels[i][1] - levels[i - 1][1]);
      return static_cast<std::uint8_t>(levels[i - 1][0] + share * (levels[i][0] - levels[i - 1][0]) + 0.5);
    }
  return static_cast<std::uint8_t>(levels.back()[0]);
}

// Calls each(at, index) for every voxel `at` of `to` with its continuous index in `from`.
template <class F>
void each_voxel(const grid::Lattice& from, const grid::Lattice& to, const Progress& progress, F&& each) {
  const Vec3 start = from.to_index(to.origin_mm);
  std::array<Vec3, 3> step;
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 next = to.origin_mm;
    next[axis] += to.spacing_mm[axis];
    step[static_cast<std::size_t>(axis)] = from.to_index(next) - start;
  }
  parallel_for(0, to.size[2], 1, [&](std::int64_t begin, std::int64_t end) {
    for (auto k = static_cast<int>(begin); k < end; ++k) {
      progress.check();
      for (int j = 0; j < to.size[1]; ++j)
        for (int i = 0; i < to.size[0]; ++i)
          each(to.index(i, j, k), start + step[0] * double(i) + step[1] * double(j) + step[2] * double(k));
    }
  });
}

bool nearest(const grid::Lattice& lattice, Vec3 index, std::array<int, 3>& voxel) {
  for (int k = 0; k < 3; ++k) {
    if (!(index[k] > -0.5 && index[k] < lattice.size[k] - 0.5)) return false;
    voxel[static_cast<std::size_t>(k)] = static_cast<int>(std::lround(index[k]));
  }
  return true;
}

// Along the axes every voxel is one of the volume's own: nothing is interpolated.
template <class T>
PackedVolume along_axes(const grid::Grid<T>& from, const grid::Lattice& to, const Progress& progress) {
  PackedVolume out;
  out.lattice = to;
  out.bytes.assign(to.count(), '\0');
  // For each axis of the page how far on in the volume each of its voxels lies; -1: beyond it.
  std::array<std::vector<std::ptrdiff_t>, 3> at;
  const std::ptrdiff_t stride[3] = {1, from.size[0], std::ptrdiff_t(from.size[0]) * from.size[1]};
  const Vec3 start = from.to_index(to.origin_mm);
  for (int k = 0; k < 3; ++k) {
    const int axis = *patient_axis(from, k);
    Vec3 next = to.origin_mm;
    next[axis] += to.spacing_mm[axis];
    const double step = from.to_index(next)[k] - start[k];
    for (int n = 0; n < to.size[axis]; ++n) {
      const double index = start[k] + step * n;
      at[std::size_t(axis)].push_back(
          index > -0.5 && index < from.size[k] - 0.5 ? stride[k] * std::ptrdiff_t(std::lround(index)) : -1);
    }
  }
  parallel_for(0, to.size[2], 1, [&](std::int64_t begin, std::int64_t end) {
    for (auto k = static_cast<int>(begin); k < end; ++k) {
      progress.check();
      for (int j = 0; j < to.size[1]; ++j) {
        const std::ptrdiff_t y = at[1][std::size_t(j)], z = at[2][std::size_t(k)];
        if (y < 0 || z < 0) continue;
        char* row = &out.bytes[to.index(0, j, k)];
        for (int i = 0; i < to.size[0]; ++i)
          if (const std::ptrdiff_t x = at[0][std::size_t(i)]; x >= 0)
            row[i] = static_cast<char>(level_of(from.voxels[std::size_t(x + y + z)]));
      }
    }
  });
  return out;
}

constexpr double edge_slack = 1e-6;  // voxels: a lattice rounded to the volume's own end still lies in it

}  // namespace

PackedVolume pack_ct(const grid::Grid<std::int16_t>& volume, int side, const Progress& progress) {
  const auto step_mm = larger_voxels_mm(volume, side);
  if (step_mm) return pack_ct(grid::resampled_grid(volume, *step_mm), side, progress);
  const grid::Lattice to = page_lattice(volume, side);
  if (to.count() == volume.count() && patient_axis(volume, 0) && patient_axis(volume, 1) && patient_axis(volume, 2))
    return along_axes(volume, to, progress);
  const grid::Border border = grid::value_beyond(page_hu_levels.front()[1], edge_slack);
  PackedVolume out{to, std::string(to.count(), '\0')};
  each_voxel(volume, to, progress, [&](std::size_t at, Vec3 index) {
    out.bytes[at] = static_cast<char>(level_of(grid::sampled(volume, index, border)));
  });
  return out;
}

std::string predicted_bytes(const PackedVolume& volume) {
  const grid::Lattice& l = volume.lattice;
  std::string out(volume.bytes.size(), '\0');
  parallel_for(0, l.size[2], 1, [&](std::int64_t begin, std::int64_t end) {
    for (auto k = static_cast<int>(begin); k < end; ++k)
      for (int j = 0; j < l.size[1]; ++j)
        for (int i = 0; i < l.size[0]; ++i) {
          const auto at = [&](int x, int y) {
            return x < 0 || y < 0 ? 0 : int(static_cast<unsigned char>(volume.bytes[l.index(x, y, k)]));
          };
          const int left = at(i - 1, j), above = at(i, j - 1), level = left + above - at(i - 1, j - 1);
          const int median = std::max(std::min(left, above), std::min(std::max(left, above), level));
          out[l.index(i, j, k)] = static_cast<char>(at(i, j) - median);
        }
  });
  return out;
}

PackedShapes pack_shapes(const voxel::HapticVolume& volume, const Progress& progress) {
  const voxel::HapticDecoder decoder(volume);
  grid::Lattice to = page_lattice(volume.voxels, page_volume_side);
  for (int axis = 0; axis < 3; ++axis)
    if (to.size[axis] > page_volume_side) {
      const double length = to.spacing_mm[axis] * (to.size[axis] - 1);
      to.size[axis] = page_volume_side;
      to.spacing_mm[axis] = length / (page_volume_side - 1);
    }
  const bool has_shares = volume.encoding == voxel::HapticEncoding::occupancy;
  PackedShapes out{{to, std::string(to.count(), '\0')}, std::string(has_shares ? 2 * to.count() : 0, '\0')};
  each_voxel(volume.voxels, to, progress, [&](std::size_t at, Vec3 index) {
    std::array<int, 3> v{};
    if (!nearest(volume.voxels, index, v)) return;
    const auto shapes = has_shares ? voxel::shapes_of_voxel(volume.voxels, v[0], v[1], v[2]) : voxel::VoxelShapes();
    out.numbers.bytes[at] = static_cast<char>(has_shares ? shapes.number : decoder.shape_at(v[0], v[1], v[2]));
    if (!has_shares) return;
    // Steps of 17 of 255 lay a surface at most 1/30 of a voxel aside, and take half the bytes.
    out.shares[at] = static_cast<char>(shapes.share > 0 ? std::max(1, (shapes.share + 8) / 17) * 17 : 0);
    out.shares[to.count() + at] = static_cast<char>(shapes.rest);
  });
  return out;
}

}  // namespace trephine::page
