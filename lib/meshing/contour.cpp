// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/contour.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <type_traits>

#include "base/error.h"
#include "base/parallel.h"
#include "base/refusal.h"
#include "meshing/enclosed.h"
#include "meshing/exact.h"
#include "meshing/marching_cubes.h"
#include "meshing/validity.h"
#include "surface/cell_merge.h"
#include "surface/incidence.h"

namespace trephine::meshing {
namespace {

constexpr double first_margin = 0.002, last_margin = 0.05;

void require_surface(const grid::Lattice& lattice, const InsideVoxels& inside) {
  const std::string of = std::to_string(inside.count) + " of " + std::to_string(lattice.count()) + " voxels are inside";
  const auto fail = [](const std::string& what) {
    throw refusal("contour", what, {"set another `isovalue_hu`, or other thresholds in the stage that made the field"});
  };
  if (inside.count == 0) fail(of + ", there is no surface");
  if (inside.count == lattice.count()) fail(of + ", there is no surface but the volume's border");
  for (int a = 0; a < 3; ++a)
    if (inside.box.end[a] - inside.box.begin[a] < 2) fail(of + ", all in one slice: too thin for a surface");
}

/// Transforms continuous indices to patient mm about a local origin. The triangles are oriented outwards, whether the
/// lattice is right-handed or left-handed.
void to_patient(surface::TriMesh& mesh, const grid::Lattice& lattice) {
  Vec3 low = mesh.points_mm.front(), high = low;
  for (const Vec3 p : mesh.points_mm)
    for (int a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], p[a]);
      high[a] = std::max(high[a], p[a]);
    }
  const Vec3 s = lattice.spacing_mm;
  const double extent = std::max({(high.x - low.x) * s.x, (high.y - low.y) * s.y, (high.z - low.z) * s.z});
  const double unit = std::min(1.0, std::exp2(std::floor(std::log2(extent)) - 5));
  const Vec3 centre = lattice.to_world_mm((low + high) / 2);
  for (int a = 0; a < 3; ++a) mesh.origin_mm[a] = std::nearbyint(centre[a] / unit) * unit;
  const Vec3 offset = lattice.origin_mm - mesh.origin_mm;
  parallel_for(0, static_cast<std::int64_t>(mesh.points_mm.size()), 65536, [&](std::int64_t from, std::int64_t to) {
    for (std::int64_t i = from; i < to; ++i) {
      const Vec3 p = mesh.points_mm[i];
      mesh.points_mm[i] = lattice.direction * Vec3{p.x * s.x, p.y * s.y, p.z * s.z} + offset;
    }
  });
  if (determinant(lattice.direction) < 0)
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
}

/// Back to continuous indices, about as far as float32 allows.
Vec3 to_index(const surface::TriMesh& mesh, const grid::Lattice& lattice, Vec3 p) {
  const Vec3 s = lattice.spacing_mm, q = transpose_times(lattice.direction, p - (lattice.origin_mm - mesh.origin_mm));
  return {q.x / s.x, q.y / s.y, q.z / s.z};
}

/// Moves the points of the triangles, and of the triangles around them, away from the ends of their lattice edges.
struct DrawnIn {
  std::size_t points_count = 0;
  double most_mm = 0;  ///< moved
};
DrawnIn draw_in(surface::TriMesh& mesh, const grid::Lattice& lattice, const std::vector<std::uint32_t>& triangles,
                double margin) {
  std::vector<char> marked(mesh.points_mm.size(), 0);
  for (const std::uint32_t t : triangles)
    for (const std::uint32_t v : mesh.triangles[t]) marked[v] = 1;
  std::vector<char> around = marked;
  for (const auto& t : mesh.triangles)
    if (marked[t[0]] || marked[t[1]] || marked[t[2]])
      for (const std::uint32_t v : t) around[v] = 1;
  const Vec3 s = lattice.spacing_mm, offset = lattice.origin_mm - mesh.origin_mm;
  DrawnIn out;
  for (std::size_t i = 0; i < around.size(); ++i) {
    if (!around[i]) continue;
    Vec3 p = to_index(mesh, lattice, mesh.points_mm[i]);
    int axis = 0;  // the one along which the point lies between two samples
    const auto off = [&p](int a) { return std::abs(p[a] - std::nearbyint(p[a])); };
    for (int a = 1; a < 3; ++a)
      if (off(a) > off(axis)) axis = a;
    for (int a = 0; a < 3; ++a)
      if (a != axis) p[a] = std::nearbyint(p[a]);
    const double low = std::floor(p[axis]);
    p[axis] = low + std::clamp(p[axis] - low, margin, 1 - margin);
    const Vec3 now = lattice.direction * Vec3{p.x * s.x, p.y * s.y, p.z * s.z} + offset;
    out.most_mm = std::max(out.most_mm, norm(now - mesh.points_mm[i]));
    mesh.points_mm[i] = now;
    ++out.points_count;
  }
  return out;
}

/// Divides the boxes in which the triangles lie; false: none of them holds merged triangles.
bool divide_at(surface::CellMerge& merge, const surface::TriMesh& mesh, const grid::Lattice& lattice,
               const std::vector<std::uint32_t>& triangles, const Progress& progress) {
  std::vector<Vec3> places;
  for (const std::uint32_t t : triangles) {
    const auto& v = mesh.triangles[t];
    places.push_back(to_index(mesh, lattice, (mesh.points_mm[v[0]] + mesh.points_mm[v[1]] + mesh.points_mm[v[2]]) / 3));
  }
  return merge.divide(places, progress) > 0;
}

/// Rounds the mesh to float32 and makes it valid there. Where it is invalid, boxes of merged triangles are divided;
/// where there are none left, rounding is the cause, and points are moved further from the ends of their edges.
Validity make_valid(surface::TriMesh& mesh, const grid::Lattice& lattice, surface::CellMerge* merge,
                    ContourResult& result, const Progress& progress) {
  double margin = first_margin;
  for (;;) {
    progress.check();
    snap_to_float32(mesh);
    const Validity v = check_validity(mesh, progress, merge ? nullptr : &lattice);
    if (v.valid()) return v;
    std::vector<std::uint32_t> faults = degenerate_triangles(mesh);
    for (const auto& pair : self_intersections(mesh, progress)) faults.insert(faults.end(), pair.begin(), pair.end());
    if (merge && divide_at(*merge, mesh, lattice, faults, progress)) {
      mesh = merge->mesh();
      to_patient(mesh, lattice);
      continue;
    }
    merge = nullptr;
    margin = std::min(2.5 * margin, 1.0);
    if (faults.empty() || margin > last_margin)
      throw refusal("contour", v.text(),
                    {"this is a fault of the program: an `isovalue_hu` a little higher or lower may go round it"});
    const DrawnIn drawn = draw_in(mesh, lattice, faults, margin);
    result.points_drawn_in_count += drawn.points_count;
    if (result.merged) result.merged->within_proven_mm += drawn.most_mm;
  }
}

template <class T>
Outcome<surface::TriMesh, ContourResult> contour_grid(const grid::Grid<T>& grid, double isovalue,
                                                      const ContourParams& params, const Progress& progress) {
  const InsideVoxels inside = find_inside(grid, isovalue);
  require_surface(grid, inside);
  surface::TriMesh mesh = marching_cubes(grid, isovalue, inside, first_margin, progress.part(0, 0.4));
  const bool merges = params.within_mm > 0;
  if (!merges) to_patient(mesh, grid);
  int pieces = 2;
  const int cavities = params.keep_cavities ? 0 : drop_cavities(mesh, pieces, progress.part(0.4, 0.5));
  // Marching cubes leave one fan a point.
  const double unit_mm3 = merges ? grid.voxel_volume_mm3() : 1;
  const int small = pieces < 2 ? 0 : surface::keep_large_fan_components(mesh, params.min_component_mm3 / unit_mm3);
  ContourResult result;
  surface::TriMesh cubes;
  std::optional<surface::CellMerge> merge;
  if (merges) {
    cubes = std::move(mesh);
    merge.emplace(cubes, grid.spacing_mm, params.within_mm, triangles_intersect, progress.part(0.5, 0.6));
    result.merged = {params.within_mm, cubes.triangles.size(), 0};
    mesh = merge->mesh();
    to_patient(mesh, grid);
  }
  const Validity v = make_valid(mesh, grid, merge ? &*merge : nullptr, result, progress.part(0.6, 0.95));
  if (merge) result.merged->boxes_divided_count = merge->boxes_divided_count();

  result.inside_voxels_count = inside.count;
  result.triangles_count = mesh.triangles.size();
  result.points_count = mesh.points_mm.size();
  result.volume_ml = v.volume_mm3 / 1000;
  result.components_count = v.topology.components;
  result.genus_count = v.topology.genus;
  result.small_components_dropped_count = small;
  result.cavities_dropped_count = cavities;
  progress.report(1);
  return {std::move(mesh), result, {}};
}

}  // namespace

Outcome<surface::TriMesh, ContourResult> contour(const grid::Field& field, const ContourParams& params,
                                                 const Progress& progress) {
  return contour_grid(field, 0.0, params, progress);
}

Outcome<surface::TriMesh, ContourResult> contour(const grid::HuVolume& volume, const ContourParams& params,
                                                 const Progress& progress) {
  return std::visit(
      [&](const auto& grid) {
        double isovalue = params.isovalue_hu;
        const bool lowered =
            std::is_integral_v<typename std::decay_t<decltype(grid)>::Sample> && isovalue == std::floor(isovalue);
        if (lowered) isovalue -= 0.5;
        auto made = contour_grid(grid, isovalue, params, progress);
        made.result.isovalue_hu = isovalue;
        if (lowered)
          made.warnings.push_back({"isovalue_lowered", "isovalue lowered by 1/2 HU: the samples are integers", {}});
        return made;
      },
      volume);
}

surface::TriMesh contour_to_look_at(const grid::Field& field, const Progress& progress) {
  const InsideVoxels inside = find_inside(field, 0.0);
  require_surface(field, inside);
  surface::TriMesh mesh = marching_cubes(field, 0.0, inside, first_margin, progress);
  to_patient(mesh, field);
  snap_to_float32(mesh);
  return mesh;
}

}  // namespace trephine::meshing
