// SPDX-License-Identifier: GPL-3.0-or-later
#include "grid/grid.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace trephine::grid {

bool operator==(const Lattice& a, const Lattice& b) {
  return a.size == b.size && a.spacing_mm == b.spacing_mm && a.origin_mm == b.origin_mm && a.direction == b.direction;
}

Box whole_box(const Lattice& lattice) { return {{0, 0, 0}, lattice.size}; }

Box grown(const Box& box, int margin, const Lattice& lattice) {
  Box out;
  for (int a = 0; a < 3; ++a) {
    out.begin[a] = std::clamp(box.begin[a] - margin, 0, lattice.size[a]);
    out.end[a] = std::clamp(box.end[a] + margin, 0, lattice.size[a]);
  }
  return out;
}

Lattice cropped(const Lattice& lattice, const Box& box) {
  Lattice out = lattice;
  for (int a = 0; a < 3; ++a) out.size[a] = std::max(0, box.end[a] - box.begin[a]);
  if (box.begin != std::array<int, 3>{0, 0, 0})
    out.origin_mm = lattice.to_world_mm({double(box.begin[0]), double(box.begin[1]), double(box.begin[2])});
  return out;
}

Box place_in(const Lattice& part, const Lattice& whole) {
  constexpr double tolerance_voxels = 1e-3;
  const auto refuse = [](const char* field, const std::string& what) {
    throw Error(ExitCode::bad_input, "", field, what);
  };
  Box box;
  const Vec3 first = whole.to_index(part.origin_mm);
  if (!is_finite(first)) refuse("origin", "not finite");
  for (int a = 0; a < 3; ++a) {
    const std::string axis = "axis " + std::to_string(a);
    // How far the far end of the part is off, in voxels, because the steps differ.
    const Vec3 step =
        transpose_times(whole.direction, part.direction.column[a] * part.spacing_mm[a]) * double(part.size[a]);
    for (int b = 0; b < 3; ++b) {
      const double want = a == b ? double(part.size[a]) : 0.0;
      if (!(std::abs(step[b] / whole.spacing_mm[b] - want) <= tolerance_voxels))
        refuse("spacing or direction", axis + " is not that of the other volume: they are not the same raster");
    }
    const double rounded = std::round(first[a]);
    if (!(std::abs(first[a] - rounded) <= tolerance_voxels))
      refuse("origin", axis + " is off by " + std::to_string(std::abs(first[a] - rounded)) +
                           " voxels: they are not the same raster");
    if (!(std::abs(rounded) < 1e9)) refuse("origin", axis + " lies too far from the other volume");
    box.begin[a] = static_cast<int>(rounded);
    box.end[a] = box.begin[a] + part.size[a];
  }
  return box;
}

template <class T>
Grid<T> crop(const Grid<T>& grid, const Box& box) {
  for (int a = 0; a < 3; ++a)
    if (box.begin[a] < 0 || box.end[a] > grid.size[a] || box.begin[a] > box.end[a])
      throw Error(ExitCode::internal, "", "crop", "the box leaves the volume");
  Grid<T> out(cropped(grid, box));
  for (int k = 0; k < out.size[2]; ++k)
    for (int j = 0; j < out.size[1]; ++j) {
      const auto from = grid.voxels.begin() + grid.index(box.begin[0], j + box.begin[1], k + box.begin[2]);
      std::copy(from, from + out.size[0], out.voxels.begin() + out.index(0, j, k));
    }
  return out;
}

template <class T>
Grid<T> fit(const Grid<T>& grid, const Lattice& lattice, T outside) {
  Grid<T> out(lattice, outside);
  const Box place = place_in(grid, lattice);
  const int i0 = std::max(0, place.begin[0]), i1 = std::min(lattice.size[0], place.end[0]);
  if (i0 >= i1) return out;
  for (int k = std::max(0, place.begin[2]); k < std::min(lattice.size[2], place.end[2]); ++k)
    for (int j = std::max(0, place.begin[1]); j < std::min(lattice.size[1], place.end[1]); ++j) {
      const auto from = grid.voxels.begin() + grid.index(i0 - place.begin[0], j - place.begin[1], k - place.begin[2]);
      std::copy(from, from + (i1 - i0), out.voxels.begin() + out.index(i0, j, k));
    }
  return out;
}

template Grid<std::int16_t> crop(const Grid<std::int16_t>&, const Box&);
template Grid<float> crop(const Grid<float>&, const Box&);
template Grid<std::uint8_t> crop(const Grid<std::uint8_t>&, const Box&);
template Grid<std::int16_t> fit(const Grid<std::int16_t>&, const Lattice&, std::int16_t);
template Grid<float> fit(const Grid<float>&, const Lattice&, float);
template Grid<std::uint8_t> fit(const Grid<std::uint8_t>&, const Lattice&, std::uint8_t);

}  // namespace trephine::grid
