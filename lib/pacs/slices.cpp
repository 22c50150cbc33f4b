// SPDX-License-Identifier: GPL-3.0-or-later
#include "pacs/slices.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "surface/inside.h"

namespace trephine::pacs {

grid::Lattice SliceSet::lattice_of(std::size_t slice) const {
  grid::Lattice l;
  l.size = {columns, rows, 1};
  l.spacing_mm = {dx_mm, dy_mm, thickness_mm > 0 ? thickness_mm : 1};
  l.origin_mm = origins_mm[slice];
  l.direction.column = {u, v, normal()};
  return l;
}

double SliceSet::uniform_step_mm() const {
  if (origins_mm.size() < 2) return 0;
  const double step = dot(origins_mm.back() - origins_mm.front(), normal()) / double(origins_mm.size() - 1);
  for (std::size_t k = 1; k < origins_mm.size(); ++k)
    if (std::abs(dot(origins_mm[k] - origins_mm[k - 1], normal()) - step) > 1e-3) return 0;
  return step;
}

SliceSet slices_of(const grid::Lattice& lattice) {
  SliceSet s;
  s.columns = lattice.size[0];
  s.rows = lattice.size[1];
  s.dx_mm = lattice.spacing_mm.x;
  s.dy_mm = lattice.spacing_mm.y;
  s.thickness_mm = lattice.spacing_mm.z;
  s.u = lattice.direction.column[0];
  s.v = lattice.direction.column[1];
  for (int k = 0; k < lattice.size[2]; ++k) s.origins_mm.push_back(lattice.to_world_mm({0, 0, double(k)}));
  if (dot(s.normal(), lattice.direction.column[2]) < 0) std::reverse(s.origins_mm.begin(), s.origins_mm.end());
  return s;
}

std::string packed(const std::vector<std::uint8_t>& pixels) {
  std::string out((pixels.size() + 7) / 8, '\0');
  for (std::size_t i = 0; i < pixels.size(); ++i)
    if (pixels[i]) out[i / 8] = static_cast<char>(out[i / 8] | 1 << i % 8);
  return out;
}

SliceBits bits_inside(const surface::TriMesh& mesh, const SliceSet& slices, const Progress& progress) {
  SliceBits bits(slices.origins_mm.size());
  const surface::Bounds bounds = surface::bounds_of(mesh);
  const Vec3 n = slices.normal();
  // The box's support along the normal says which slices can meet the surface.
  double low = 0, high = 0;
  for (int a = 0; a < 3; ++a) {
    low += n[a] * (n[a] > 0 ? bounds.min_mm[a] : bounds.max_mm[a]);
    high += n[a] * (n[a] > 0 ? bounds.max_mm[a] : bounds.min_mm[a]);
  }
  parallel_for(0, std::int64_t(bits.size()), 1, [&](std::int64_t k, std::int64_t) {
    progress.check();
    const double at = dot(slices.origins_mm[std::size_t(k)], n);
    if (at < low || at > high) return;
    const grid::Mask mask = surface::voxelize_inside(mesh, slices.lattice_of(std::size_t(k)));
    if (std::none_of(mask.voxels.begin(), mask.voxels.end(), [](std::uint8_t v) { return v != 0; })) return;
    bits[std::size_t(k)] = packed(mask.voxels);
  });
  return bits;
}

std::vector<std::int16_t> resampled_on(const grid::Grid<std::int16_t>& volume, const SliceSet& slices,
                                       std::size_t slice, std::int16_t outside) {
  constexpr double on_voxel = 1e-3;
  const grid::Lattice plane = slices.lattice_of(slice);
  std::vector<std::int16_t> out(slices.pixels(), outside);
  std::size_t n = 0;
  for (int j = 0; j < slices.rows; ++j)
    for (int i = 0; i < slices.columns; ++i, ++n) {
      const Vec3 q = volume.to_index(plane.to_world_mm({double(i), double(j), 0}));
      int low[3];
      double part[3];
      bool in = true;
      for (int a = 0; a < 3; ++a) {
        in = in && q[a] >= -on_voxel && q[a] <= volume.size[a] - 1 + on_voxel;
        low[a] = std::clamp(in ? int(std::floor(q[a] + on_voxel)) : 0, 0, volume.size[a] - 1);
        part[a] = std::abs(q[a] - low[a]) <= on_voxel ? 0 : q[a] - low[a];
      }
      if (!in) continue;
      double sum = 0;
      for (int corner = 0; corner < 8; ++corner) {
        double weight = 1;
        int at[3];
        for (int a = 0; a < 3; ++a) {
          const bool up = corner >> a & 1;
          weight *= up ? part[a] : 1 - part[a];
          at[a] = std::min(low[a] + int(up), volume.size[a] - 1);
        }
        if (weight > 0) sum += weight * volume.at(at[0], at[1], at[2]);
      }
      out[n] = static_cast<std::int16_t>(std::lround(sum));
    }
  return out;
}

}  // namespace trephine::pacs
