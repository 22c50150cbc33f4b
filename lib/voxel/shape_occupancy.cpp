// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxel/shape_occupancy.h"

#include <algorithm>
#include <utility>

#include "base/error.h"
#include "base/parallel.h"
#include "surface/bvh.h"
#include "surface/inside.h"
#include "surface/point_triangle.h"
#include "surface/triangle_frame.h"

namespace trephine::voxel::detail {
namespace {

constexpr std::int64_t rows_a_piece = 16;
constexpr int slices_a_slab = 8;

void check_size(const surface::TriMesh& mesh) {
  if (mesh.triangles.empty()) throw Error(ExitCode::bad_input, "", "surface", "has no triangles");
  const surface::Bounds b = surface::bounds_of(mesh);
  for (int a = 0; a < 3; ++a)
    if (!(std::max(std::abs(b.min_mm[a]), std::abs(b.max_mm[a])) <= 1e9))
      throw Error(ExitCode::bad_input, "", "surface", "has points beyond 1e9 mm");
}

// Unit direction from the surface to the point, or the triangle's where the point lies on it.
Vec3 direction_from(const surface::TriMesh& mesh, std::uint32_t triangle, Vec3 to_point) {
  const double d = norm(to_point);
  return d > 1e-9 ? to_point / d : normalized(surface::triangle_normal(mesh, triangle));
}

int whole(double v, int size) { return int(std::clamp(v, 0.0, double(size))); }

// The triangles, seen from a lattice: corners in continuous indices, and how far beyond its box along each axis voxels
// on a triangle's ramp may lie: n_a ramp(n) is at most (h_a + |h|) / 2 over all unit vectors n.
struct OnLattice {
  const surface::TriMesh& mesh;
  const grid::Lattice& lattice;
  std::vector<Vec3> points;
  Vec3 reach;

  OnLattice(const surface::TriMesh& m, const grid::Lattice& l) : mesh(m), lattice(l), points(m.points_mm.size()) {
    for (int a = 0; a < 3; ++a) reach[a] = 0.5 * (1 + largest_ramp_mm(l) / l.spacing_mm[a]) + 1e-6;
    parallel_for(0, std::int64_t(points.size()), 1 << 14, [&](std::int64_t from, std::int64_t to) {
      for (std::int64_t p = from; p < to; ++p) points[std::size_t(p)] = l.to_index(m.world_mm(std::size_t(p)));
    });
  }
  // Voxels along an axis that the triangle's ramp may reach.
  void range(std::uint32_t triangle, int axis, int& begin, int& end) const {
    const auto& v = mesh.triangles[triangle];
    const double p = points[v[0]][axis], q = points[v[1]][axis], r = points[v[2]][axis];
    const int size = lattice.size[std::size_t(axis)];
    begin = whole(std::ceil(std::min({p, q, r}) - reach[axis]), size);
    end = whole(std::floor(std::max({p, q, r}) + reach[axis]) + 1, size);
  }
};

// The nearest triangle of each voxel of a few slices, as far as the widest ramp reaches. Every triangle visits the
// voxels about it: far fewer steps than a search in a tree for each voxel.
class Slab {
 public:
  Slab(const OnLattice& on, int k_begin, int k_end)
      : on_(on),
        lattice_(on.lattice),
        k_begin_(k_begin),
        k_end_(k_end),
        rows_(std::size_t(k_end - k_begin) * std::size_t(on.lattice.size[1])),
        nearest_(rows_ * std::size_t(on.lattice.size[0]),
                 {std::pow(largest_ramp_mm(on.lattice), 2), float(1.001 * largest_ramp_mm(on.lattice)), none}),
        origin_(lattice_.origin_mm - on.mesh.origin_mm) {
    for (int a = 0; a < 3; ++a) step_[a] = lattice_.direction.column[std::size_t(a)] * lattice_.spacing_mm[a];
  }

  void visit(std::uint32_t t) {
    const auto& v = on_.mesh.triangles[t];
    const Vec3 a = on_.mesh.points_mm[v[0]], b = on_.mesh.points_mm[v[1]], c = on_.mesh.points_mm[v[2]];
    const Vec3 normal = normalized(surface::triangle_normal(on_.mesh, t));
    const Vec3 middle = (a + b + c) / 3;
    const double around =
        std::sqrt(std::max({squared(a - middle), squared(b - middle), squared(c - middle)})) + rounding_mm;
    const double widest = largest_ramp_mm(lattice_), rise = dot(normal, step_[0]);
    // Over the triangle's plane, of the first voxel of row (0, 0), and how it changes from row to row.
    const double height_0 = dot(normal, origin_ - a), rise_j = dot(normal, step_[1]), rise_k = dot(normal, step_[2]);
    const bool meets = std::abs(rise) > 1e-6 * lattice_.spacing_mm.x;
    const double inverse = meets ? 1 / rise : 0, half = widest * std::abs(inverse);
    const surface::TriangleFrame frame(a, b, c);
    int begin[3], end[3];
    for (int axis = 0; axis < 3; ++axis) on_.range(t, axis, begin[axis], end[axis]);
    for (int k = std::max(begin[2], k_begin_); k < std::min(end[2], k_end_); ++k)
      for (int j = begin[1]; j < end[1]; ++j) {
        const double height = height_0 + rise_j * j + rise_k * k;
        // The part of the row that is near the triangle's plane.
        int first = begin[0], last = end[0];
        if (meets) {
          const double at = -height * inverse;
          first = std::max(first, whole(at - half, lattice_.size[0]));
          last = std::min(last, whole(at + half + 2, lattice_.size[0]));
        }
        Nearest* row = &nearest_[index(0, j, k)];
        const Vec3 start = local(0, j, k);
        for (int i = first; i < last; ++i) {
          Nearest& best = row[i];
          if (std::abs(height + rise * i) >= best.mm + rounding_mm) continue;
          const Vec3 p = start + step_[0] * i;
          // No point of the triangle is nearer than the ball around it.
          const double reach = best.mm + around;
          if (squared(p - middle) >= reach * reach) continue;
          const surface::ClosestPoint n = frame.nearest(p);
          if (n.squared_mm2 >= best.squared) continue;
          best = {n.squared_mm2, float(std::sqrt(n.squared_mm2) * 1.000001), t};
        }
      }
  }

  // Writes the ramp over 0 and 255 of outside and inside.
  void write(grid::Grid<std::uint8_t>& occupancy) const {
    for (int k = k_begin_; k < k_end_; ++k)
      for (int j = 0; j < lattice_.size[1]; ++j)
        for (int i = 0; i < lattice_.size[0]; ++i) {
          const std::uint32_t t = nearest_[index(i, j, k)].triangle;
          if (t == none) continue;
          const auto& v = on_.mesh.triangles[t];
          const Vec3 p = local(i, j, k);
          const surface::ClosestPoint n = surface::nearest_on_triangle(
              p, on_.mesh.points_mm[v[0]], on_.mesh.points_mm[v[1]], on_.mesh.points_mm[v[2]]);
          const double d = std::sqrt(n.squared_mm2);
          const double ramp = ramp_mm(lattice_, direction_from(on_.mesh, t, p - n.point));
          std::uint8_t& o = occupancy.voxels[lattice_.index(i, j, k)];
          o = std::uint8_t(share_at(o ? -d : d, ramp > 0 ? ramp : 1e-9));
        }
  }

 private:
  static constexpr std::uint32_t none = 0xffffffff;
  static constexpr double rounding_mm = 1e-6;  ///< far above that of distances
  struct Nearest {
    double squared;
    float mm;  ///< its root, rounded up
    std::uint32_t triangle;
  };
  static double squared(Vec3 v) { return dot(v, v); }
  std::size_t index(int i, int j, int k) const {
    return (std::size_t(k - k_begin_) * std::size_t(lattice_.size[1]) + std::size_t(j)) *
               std::size_t(lattice_.size[0]) +
           std::size_t(i);
  }
  Vec3 local(int i, int j, int k) const { return origin_ + step_[0] * i + step_[1] * j + step_[2] * k; }

  const OnLattice& on_;
  const grid::Lattice& lattice_;
  int k_begin_, k_end_;
  std::size_t rows_;
  std::vector<Nearest> nearest_;
  Vec3 origin_, step_[3];  ///< in the mesh's own coordinates
};

// The signed distance to a surface, positive outside, at every second voxel; it is linear between them.
class Distances {
 public:
  // For the voxels whose `wanted` is not 0. Beyond low_mm and high_mm it is only known to be beyond.
  Distances(const surface::TriMesh& mesh, const grid::Grid<std::uint8_t>& wanted, double low_mm, double high_mm,
            const Progress& progress) {
    grid::Lattice l = wanted;
    l.spacing_mm = l.spacing_mm * 2;
    for (int& n : l.size) n = n / 2 + 1;
    mm_ = grid::Grid<float>(l);
    ramp_mm_.assign(l.count(), 0);
    const grid::Mask inside = surface::voxelize_inside(mesh, l, progress.silent());
    grid::Mask asked(l, 0);
    for (int k = 0; k < wanted.size[2]; ++k)
      for (int j = 0; j < wanted.size[1]; ++j)
        for (int i = 0; i < wanted.size[0]; ++i)
          if (wanted.at(i, j, k))
            for (int n = 0; n < 8; ++n) asked.at((i + (n & 1)) / 2, (j + (n >> 1 & 1)) / 2, (k + (n >> 2)) / 2) = 1;
    const surface::Bvh tree(mesh, progress);
    // A place so far beyond has a part in no voxel that is not: none is farther from it than a voxel's diagonal.
    const double spare_mm = largest_ramp_mm(wanted), low = low_mm - spare_mm, high = high_mm + spare_mm;
    const std::int64_t rows = std::int64_t(l.size[1]) * l.size[2];
    parallel_for(0, rows, rows_a_piece, [&](std::int64_t from, std::int64_t to) {
      progress.check();
      std::uint32_t seed = 0;
      for (std::int64_t row = from; row < to; ++row) {
        const int j = int(row % l.size[1]), k = int(row / l.size[1]);
        int known_to = 0;
        float value = 0, ramp = 0;
        for (int i = 0; i < l.size[0]; ++i) {
          if (!asked.at(i, j, k)) continue;
          if (i >= known_to) {
            const Vec3 local = l.to_world_mm({double(i), double(j), double(k)}) - mesh.origin_mm;
            const bool in = inside.at(i, j, k);
            const surface::ClosestPoint c = tree.nearest(local, seed, std::max(0.0, in ? -high : low), seed);
            const double away = std::sqrt(c.squared_mm2), d = in ? -away : away;
            value = float(std::clamp(d, low, high));
            ramp = float(ramp_mm(wanted, direction_from(mesh, seed, local - c.point)));
            // A distance changes by a step at most from place to place.
            known_to = i + 1 + int(std::clamp(std::max(low - d, d - high) / l.spacing_mm.x, 0.0, 1e6));
          }
          ramp_mm_[mm_.index(i, j, k)] = ramp;
          mm_.at(i, j, k) = value;
        }
      }
    });
  }

  // And half the width of the ramp there.
  std::pair<double, double> at(int i, int j, int k) const {
    double d = 0, ramp = 0;
    for (int n = 0; n < 8; ++n) {
      const std::size_t v = mm_.index((i + (n & 1)) / 2, (j + (n >> 1 & 1)) / 2, (k + (n >> 2)) / 2);
      d += mm_.voxels[v];
      ramp += ramp_mm_[v];
    }
    return {d / 8, ramp > 0 ? ramp / 8 : 1e-9};
  }

 private:
  grid::Grid<float> mm_;
  std::vector<float> ramp_mm_;
};

// Calls each(i, j, k) for the voxels with a value in `which`, slice by slice in parallel.
template <class Each>
void for_each_voxel(const grid::Grid<std::uint8_t>& which, const Progress& progress, const Each& each) {
  parallel_for(0, which.size[2], 1, [&](std::int64_t k, std::int64_t) {
    progress.check();
    for (int j = 0; j < which.size[1]; ++j)
      for (int i = 0; i < which.size[0]; ++i)
        if (which.at(i, j, int(k))) each(i, j, int(k));
  });
}

}  // namespace

grid::Grid<std::uint8_t> solid_occupancy(const surface::TriMesh& mesh, const grid::Lattice& lattice,
                                         const Progress& progress) {
  surface::check_mesh(mesh);
  check_size(mesh);
  grid::Grid<std::uint8_t> occupancy = surface::voxelize_inside(mesh, lattice, progress.part(0, 0.2));
  for (std::uint8_t& v : occupancy.voxels) v = v ? 255 : 0;
  const OnLattice on(mesh, lattice);
  const int slabs = (lattice.size[2] + slices_a_slab - 1) / slices_a_slab;
  std::vector<std::vector<std::uint32_t>> triangles(std::size_t(std::max(0, slabs)));
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    int begin = 0, end = 0;
    on.range(t, 2, begin, end);
    for (int s = begin / slices_a_slab; s * slices_a_slab < end; ++s) triangles[std::size_t(s)].push_back(t);
  }
  progress.report(0.3);
  parallel_for(0, slabs, 1, [&](std::int64_t s, std::int64_t) {
    const int begin = int(s) * slices_a_slab, end = std::min(begin + slices_a_slab, lattice.size[2]);
    if (triangles[std::size_t(s)].empty()) return;
    Slab slab(on, begin, end);
    std::size_t n = 0;
    for (const std::uint32_t t : triangles[std::size_t(s)]) {
      if (n++ % 4096 == 0) progress.check();
      slab.visit(t);
    }
    slab.write(occupancy);
  });
  progress.report(1);
  return occupancy;
}

void keep_shell(const surface::TriMesh& mesh, double shell_mm, grid::Grid<std::uint8_t>& solid,
                const Progress& progress) {
  const double reach = largest_ramp_mm(solid);
  const Distances distances(mesh, solid, -shell_mm - reach, -shell_mm + reach, progress);
  for_each_voxel(solid, progress, [&](int i, int j, int k) {
    const auto [d, ramp] = distances.at(i, j, k);
    std::uint8_t& share = solid.at(i, j, k);
    share = std::min(share, std::uint8_t(share_at(-d - shell_mm, ramp)));
  });
}

Clearance clear_occupancy(const surface::TriMesh& mesh, double clear_mm, const grid::Grid<std::uint8_t>& wanted,
                          const Progress& progress) {
  surface::check_mesh(mesh);
  check_size(mesh);
  grid::Mask inside = surface::voxelize_inside(mesh, wanted, progress.part(0, 0.2));
  const double reach = largest_ramp_mm(wanted);
  const Distances distances(mesh, wanted, clear_mm - reach, clear_mm + reach, progress);
  progress.report(0.8);
  grid::Grid<std::uint8_t> clear(wanted, 255);
  for_each_voxel(wanted, progress, [&](int i, int j, int k) {
    const auto [d, ramp] = distances.at(i, j, k);
    clear.at(i, j, k) = std::uint8_t(share_at(clear_mm - d, ramp));
  });
  progress.report(1);
  return {std::move(clear), std::move(inside)};
}

}  // namespace trephine::voxel::detail
