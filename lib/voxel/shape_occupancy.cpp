// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxel/shape_occupancy.h"

#include <algorithm>

#include "base/error.h"
#include "base/parallel.h"
#include "surface/bvh.h"
#include "surface/inside.h"

namespace trephine::detail {
namespace {

constexpr std::int64_t rows_a_piece = 16;

void check_size(const TriMesh& mesh) {
  if (mesh.triangles.empty()) throw Error(ExitCode::bad_input, "", "surface", "has no triangles");
  const Bounds b = bounds_of(mesh);
  for (int a = 0; a < 3; ++a)
    if (!(std::max(std::abs(b.min_mm[a]), std::abs(b.max_mm[a])) <= 1e9))
      throw Error(ExitCode::bad_input, "", "surface", "has points beyond 1e9 mm");
}

// Marks the voxels whose centre may lie on the ramp of a triangle: n_a ramp(n) is at most (h_a + |h|) / 2 over all unit
// vectors n, so that is how far beyond the triangle's box along axis a they lie.
Grid<std::uint8_t> mark_band(const TriMesh& mesh, const Lattice& lattice, const Progress& progress) {
  Grid<std::uint8_t> band(lattice, 0);
  Vec3 reach;
  for (int a = 0; a < 3; ++a) reach[a] = 0.5 * (1 + largest_ramp_mm(lattice) / lattice.spacing_mm[a]) + 1e-6;
  std::vector<Vec3> points(mesh.points_mm.size());
  parallel_for(0, std::int64_t(points.size()), 1 << 14, [&](std::int64_t from, std::int64_t to) {
    for (std::int64_t p = from; p < to; ++p) points[std::size_t(p)] = lattice.to_index(mesh.world_mm(std::size_t(p)));
  });
  const auto whole = [](double v, int size) { return int(std::clamp(v, 0.0, double(size))); };
  parallel_for(0, std::int64_t(mesh.triangles.size()), 1 << 14, [&](std::int64_t from, std::int64_t to) {
    progress.check();
    for (std::int64_t t = from; t < to; ++t) {
      const auto& v = mesh.triangles[std::size_t(t)];
      int begin[3], end[3];
      for (int a = 0; a < 3; ++a) {
        const double p = points[v[0]][a], q = points[v[1]][a], r = points[v[2]][a];
        begin[a] = whole(std::ceil(std::min({p, q, r}) - reach[a]), lattice.size[std::size_t(a)]);
        end[a] = whole(std::floor(std::max({p, q, r}) + reach[a]) + 1, lattice.size[std::size_t(a)]);
      }
      for (int k = begin[2]; k < end[2]; ++k)
        for (int j = begin[1]; j < end[1]; ++j) {
          std::uint8_t* row = band.voxels.data() + lattice.index(0, j, k);
          for (int i = begin[0]; i < end[0]; ++i) __atomic_store_n(row + i, std::uint8_t{1}, __ATOMIC_RELAXED);
        }
    }
  });
  return band;
}

// Calls each(index, world position, seed triangle) for the voxels with a value in `which`, row by row in parallel.
template <class Each>
void for_each_voxel(const Grid<std::uint8_t>& which, const Progress& progress, const Each& each) {
  const std::int64_t rows = std::int64_t(which.size[1]) * which.size[2];
  parallel_for(0, rows, rows_a_piece, [&](std::int64_t from, std::int64_t to) {
    progress.check();
    std::uint32_t seed = 0;
    for (std::int64_t row = from; row < to; ++row) {
      const int j = int(row % which.size[1]), k = int(row / which.size[1]);
      const std::size_t begin = which.index(0, j, k);
      for (int i = 0; i < which.size[0]; ++i)
        if (which.voxels[begin + std::size_t(i)])
          each(begin + std::size_t(i), which.to_world_mm({double(i), double(j), double(k)}), seed);
    }
  });
}

// Unit direction from the surface to the point, or the triangle's where the point lies on it.
Vec3 direction_from(const TriMesh& mesh, std::uint32_t triangle, Vec3 to_point) {
  const double d = norm(to_point);
  return d > 1e-9 ? to_point / d : normalized(triangle_normal(mesh, triangle));
}

}  // namespace

Grid<std::uint8_t> solid_occupancy(const TriMesh& mesh, const Lattice& lattice, const Progress& progress) {
  check_mesh(mesh);
  check_size(mesh);
  Grid<std::uint8_t> occupancy = voxelize_inside(mesh, lattice, progress.part(0, 0.2));
  const Grid<std::uint8_t> band = mark_band(mesh, lattice, progress);
  const Bvh tree(mesh, progress);
  progress.report(0.4);
  for (std::uint8_t& v : occupancy.voxels) v = v ? 255 : 0;
  for_each_voxel(band, progress, [&](std::size_t at, Vec3 world, std::uint32_t& seed) {
    const Vec3 local = world - mesh.origin_mm;
    const ClosestPoint c = tree.nearest(local, seed, 0, seed);
    const double d = std::sqrt(c.squared_mm2);
    if (d >= largest_ramp_mm(lattice)) return;
    const double ramp = ramp_mm(lattice, direction_from(mesh, seed, local - c.point));
    occupancy.voxels[at] = std::uint8_t(share_at(occupancy.voxels[at] ? -d : d, ramp > 0 ? ramp : 1e-9));
  });
  progress.report(1);
  return occupancy;
}

Grid<std::uint8_t> clear_occupancy(const TriMesh& mesh, double clear_mm, const Grid<std::uint8_t>& wanted,
                                   const Progress& progress) {
  check_mesh(mesh);
  check_size(mesh);
  const Mask inside = voxelize_inside(mesh, wanted, progress.part(0, 0.2));
  const Bvh tree(mesh, progress);
  progress.report(0.4);
  const double reach = largest_ramp_mm(wanted), enough = std::max(0.0, clear_mm - reach);
  Grid<std::uint8_t> clear(wanted, 0);
  for_each_voxel(wanted, progress, [&](std::size_t at, Vec3 world, std::uint32_t& seed) {
    if (inside.voxels[at] && clear_mm >= reach) return;
    const Vec3 local = world - mesh.origin_mm;
    const ClosestPoint c = tree.nearest(local, seed, enough, seed);
    const double d = inside.voxels[at] ? -std::sqrt(c.squared_mm2) : std::sqrt(c.squared_mm2);
    if (d <= enough && enough > 0) return;
    const double ramp = ramp_mm(wanted, direction_from(mesh, seed, local - c.point));
    clear.voxels[at] = std::uint8_t(share_at(clear_mm - d, ramp > 0 ? ramp : 1e-9));
  });
  progress.report(1);
  return clear;
}

}  // namespace trephine::detail
