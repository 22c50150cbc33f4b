// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <variant>
#include <vector>

#include "base/vec3.h"

namespace trephine::grid {

/// The lattice of a volume: where its voxels lie, without samples. The centre of voxel (i, j, k) is origin_mm +
/// direction * (i sx, j sy, k sz), DICOM patient LPS, mm. The direction is orthonormal and may be oblique or
/// left-handed (determinant -1). i runs fastest in memory.
struct Lattice {
  std::array<int, 3> size{0, 0, 0};
  Vec3 spacing_mm{1, 1, 1};
  Vec3 origin_mm;
  Mat3 direction;

  std::size_t count() const { return std::size_t(size[0]) * size[1] * size[2]; }
  std::size_t index(int i, int j, int k) const { return (std::size_t(k) * size[1] + j) * size[0] + i; }
  bool contains(int i, int j, int k) const {
    return i >= 0 && j >= 0 && k >= 0 && i < size[0] && j < size[1] && k < size[2];
  }
  /// World position of a continuous index, and back.
  Vec3 to_world_mm(Vec3 ijk) const {
    return origin_mm + direction * Vec3{ijk.x * spacing_mm.x, ijk.y * spacing_mm.y, ijk.z * spacing_mm.z};
  }
  Vec3 to_index(Vec3 world_mm) const {
    const Vec3 v = transpose_times(direction, world_mm - origin_mm);
    return {v.x / spacing_mm.x, v.y / spacing_mm.y, v.z / spacing_mm.z};
  }
  double voxel_volume_mm3() const { return spacing_mm.x * spacing_mm.y * spacing_mm.z; }
};

bool operator==(const Lattice& a, const Lattice& b);
inline bool operator!=(const Lattice& a, const Lattice& b) { return !(a == b); }

/// Half-open box of voxel indices.
struct Box {
  std::array<int, 3> begin{0, 0, 0}, end{0, 0, 0};
  bool empty() const { return begin[0] >= end[0] || begin[1] >= end[1] || begin[2] >= end[2]; }
};
Box whole_box(const Lattice& lattice);
/// Grown by `margin` voxels on each side, within the lattice.
Box grown(const Box& box, int margin, const Lattice& lattice);
/// The lattice of that part of `lattice`: the same voxel centres.
Lattice cropped(const Lattice& lattice, const Box& box);

/// Where the lattice `part` lies in `whole`: the box that it covers, in whole's indices, possibly beyond its ends.
/// Throws Error 65 where the two are not the same raster (spacing, direction, or an offset that is not whole voxels, to
/// 1e-3).
Box place_in(const Lattice& part, const Lattice& whole);

template <class T>
struct Grid : Lattice {
  using Sample = T;
  std::vector<T> voxels;

  Grid() = default;
  explicit Grid(const Lattice& lattice, T fill = T()) : Lattice(lattice), voxels(lattice.count(), fill) {}
  T& at(int i, int j, int k) { return voxels[index(i, j, k)]; }
  const T& at(int i, int j, int k) const { return voxels[index(i, j, k)]; }
};

/// The same lattice and the same samples (without this, Lattice's would compare the lattices alone).
template <class T>
bool operator==(const Grid<T>& a, const Grid<T>& b) {
  return static_cast<const Lattice&>(a) == static_cast<const Lattice&>(b) && a.voxels == b.voxels;
}
template <class T>
bool operator!=(const Grid<T>& a, const Grid<T>& b) {
  return !(a == b);
}

template <class T>
Grid<T> crop(const Grid<T>& grid, const Box& box);
/// The grid on another lattice of the same raster: cut off, or filled up with `outside`.
template <class T>
Grid<T> fit(const Grid<T>& grid, const Lattice& lattice, T outside);

extern template Grid<std::int16_t> crop(const Grid<std::int16_t>&, const Box&);
extern template Grid<float> crop(const Grid<float>&, const Box&);
extern template Grid<std::uint8_t> crop(const Grid<std::uint8_t>&, const Box&);
extern template Grid<std::int16_t> fit(const Grid<std::int16_t>&, const Lattice&, std::int16_t);
extern template Grid<float> fit(const Grid<float>&, const Lattice&, float);
extern template Grid<std::uint8_t> fit(const Grid<std::uint8_t>&, const Lattice&, std::uint8_t);

/// HU: int16 where every slice is exact in it, else float32.
using HuVolume = std::variant<Grid<std::int16_t>, Grid<float>>;
inline const Lattice& lattice_of(const HuVolume& v) {
  return std::visit([](const auto& g) -> const Lattice& { return g; }, v);
}

/// Binary mask (0 or 1) or labels.
using Mask = Grid<std::uint8_t>;

/// A sub-voxel description of one shape: positive inside, negative outside, with its surface at 0, in any unit that
/// varies smoothly across the surface (HU, or mm). It may cover only the part of the volume's raster where the shape
/// is; everything beyond its lattice is outside, unless the volume's edge cuts the shape there. Every voxel is finite.
using Field = Grid<float>;

}  // namespace trephine::grid
