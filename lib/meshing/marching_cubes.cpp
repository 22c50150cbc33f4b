// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/marching_cubes.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <type_traits>

#include "base/error.h"
#include "base/parallel.h"
#include "base/refusal.h"
#include "meshing/cube_table.h"

namespace trephine::meshing {
namespace {

/// The nodes: the box of inside voxels with a layer around it, each marked inside or not. Rows run along i.
template <class T>
class Nodes {
 public:
  Nodes(const grid::Grid<T>& grid, double isovalue, const grid::Box& box, double margin)
      : grid_(grid), isovalue_(isovalue), margin_(margin) {
    for (int a = 0; a < 3; ++a) {
      first_[a] = box.begin[a] - 1;
      size_[a] = box.end[a] - box.begin[a] + 2;
    }
    inside_.assign(std::size_t(size_[0]) * size_[1] * size_[2], 0);
    parallel_for(1, size_[2] - 1, 4, [&](std::int64_t from, std::int64_t to) {
      for (int k = static_cast<int>(from); k < to; ++k)
        for (int j = 1; j < size_[1] - 1; ++j) {
          const T* sample = &grid_.at(first_[0] + 1, first_[1] + j, first_[2] + k);
          std::uint8_t* mark = &inside_[row(j, k) * size_[0] + 1];
          for (int i = 0; i < size_[0] - 2; ++i) mark[i] = static_cast<double>(sample[i]) > isovalue_;
        }
    });
  }

  int size(int axis) const { return size_[axis]; }
  std::size_t row(int j, int k) const { return std::size_t(k) * size_[1] + j; }
  const std::uint8_t* marks(int j, int k) const { return &inside_[row(j, k) * size_[0]]; }

  /// The point between the node and its neighbour along the axis, in the grid's continuous indices.
  Vec3 point(int i, int j, int k, int axis) const {
    const int low[3] = {first_[0] + i, first_[1] + j, first_[2] + k};
    int high[3] = {low[0], low[1], low[2]};
    ++high[axis];
    double t = 0.5;
    if (grid_.contains(low[0], low[1], low[2]) && grid_.contains(high[0], high[1], high[2])) {
      const double a = grid_.at(low[0], low[1], low[2]) - isovalue_;
      const double b = grid_.at(high[0], high[1], high[2]) - isovalue_;
      t = std::clamp(a / (a - b), margin_, 1 - margin_);
    }
    Vec3 p{double(low[0]), double(low[1]), double(low[2])};
    p[axis] += t;
    return p;
  }

 private:
  const grid::Grid<T>& grid_;
  double isovalue_, margin_;
  int first_[3], size_[3];
  std::vector<std::uint8_t> inside_;
};

/// For each row of nodes the number of its first point, in the order: its crossed edges along x, then y, then z.
struct RowPoints {
  std::vector<std::array<std::uint32_t, 3>> first;
  std::size_t total = 0;
};

/// Calls visit(i) for the nodes of the row whose edge along the axis is crossed.
template <class T, class Visit>
void for_each_crossing(const Nodes<T>& nodes, int j, int k, int axis, Visit&& visit) {
  if (axis == 1 && j + 1 == nodes.size(1)) return;
  if (axis == 2 && k + 1 == nodes.size(2)) return;
  const std::uint8_t* low = nodes.marks(j, k);
  const std::uint8_t* high = axis == 0 ? low + 1 : axis == 1 ? nodes.marks(j + 1, k) : nodes.marks(j, k + 1);
  for (int i = 0; i < nodes.size(0) - (axis == 0); ++i)
    if (low[i] != high[i]) visit(i);
}

template <class T>
RowPoints count_points(const Nodes<T>& nodes) {
  RowPoints rows;
  rows.first.resize(std::size_t(nodes.size(1)) * nodes.size(2));
  parallel_for(0, nodes.size(2), 4, [&](std::int64_t from, std::int64_t to) {
    for (int k = static_cast<int>(from); k < to; ++k)
      for (int j = 0; j < nodes.size(1); ++j)
        for (int axis = 0; axis < 3; ++axis) {
          std::uint32_t n = 0;
          for_each_crossing(nodes, j, k, axis, [&n](int) { ++n; });
          rows.first[nodes.row(j, k)][axis] = n;
        }
  });
  for (auto& row : rows.first)
    for (auto& n : row) {
      const std::size_t count = n;
      n = static_cast<std::uint32_t>(rows.total);
      rows.total += count;
    }
  return rows;
}

/// The triangles of the cells between node rows j, j + 1 and k, k + 1. On the way along i the numbers of the crossed
/// edges are counted up, so no table of them is needed.
template <class T>
void cut_row(const Nodes<T>& nodes, const RowPoints& rows, int j, int k,
             std::vector<std::array<std::uint32_t, 3>>& triangles) {
  const auto& table = cubes::table();
  const std::uint8_t* m[4] = {nodes.marks(j, k), nodes.marks(j + 1, k), nodes.marks(j, k + 1),
                              nodes.marks(j + 1, k + 1)};
  const auto first = [&](int dj, int dk) { return rows.first[nodes.row(j + dj, k + dk)]; };
  std::uint32_t x[4] = {first(0, 0)[0], first(1, 0)[0], first(0, 1)[0], first(1, 1)[0]};
  std::uint32_t y[2] = {first(0, 0)[1], first(0, 1)[1]};
  std::uint32_t z[2] = {first(0, 0)[2], first(1, 0)[2]};
  for (int i = 0; i + 1 < nodes.size(0); ++i) {
    const int low = m[0][i] | m[1][i] << 2 | m[2][i] << 4 | m[3][i] << 6;
    const int high = m[0][i + 1] << 1 | m[1][i + 1] << 3 | m[2][i + 1] << 5 | m[3][i + 1] << 7;
    const int signs = low | high;
    if (signs == 0 || signs == 255) continue;
    const bool y0 = m[0][i] != m[1][i], y1 = m[2][i] != m[3][i], z0 = m[0][i] != m[2][i], z1 = m[1][i] != m[3][i];
    const std::uint32_t id[cubes::edge_count] = {x[0], x[1],      x[2], x[3],      y[0], y[0] + y0,
                                                 y[1], y[1] + y1, z[0], z[0] + z0, z[1], z[1] + z1};
    const std::uint8_t* edge = table.edges.data();
    for (int n = table.first[signs]; n < table.first[signs + 1]; n += 3)
      triangles.push_back({id[edge[n]], id[edge[n + 1]], id[edge[n + 2]]});
    for (int r = 0; r < 4; ++r) x[r] += m[r][i] != m[r][i + 1];
    y[0] += y0;
    y[1] += y1;
    z[0] += z0;
    z[1] += z1;
  }
}

}  // namespace

template <class T>
InsideVoxels find_inside(const grid::Grid<T>& grid, double isovalue) {
  std::vector<InsideVoxels> planes(grid.size[2]);
  std::vector<std::int64_t> bad(grid.size[2], -1);
  parallel_for(0, grid.size[2], 4, [&](std::int64_t from, std::int64_t to) {
    for (int k = static_cast<int>(from); k < to; ++k) {
      InsideVoxels& p = planes[k];
      p.box = {{grid.size[0], grid.size[1], k}, {0, 0, k + 1}};
      for (int j = 0; j < grid.size[1]; ++j) {
        const T* row = &grid.at(0, j, k);
        int first = -1, last = -1;
        for (int i = 0; i < grid.size[0]; ++i) {
          if constexpr (std::is_floating_point_v<T>)
            if (!std::isfinite(row[i]) && bad[k] < 0) bad[k] = static_cast<std::int64_t>(grid.index(i, j, k));
          if (!(static_cast<double>(row[i]) > isovalue)) continue;
          if (first < 0) first = i;
          last = i;
          ++p.count;
        }
        if (first < 0) continue;
        p.box.begin[0] = std::min(p.box.begin[0], first);
        p.box.end[0] = std::max(p.box.end[0], last + 1);
        p.box.begin[1] = std::min(p.box.begin[1], j);
        p.box.end[1] = j + 1;
      }
    }
  });
  InsideVoxels all;
  for (int k = 0; k < grid.size[2]; ++k) {
    if (bad[k] >= 0) {
      const std::int64_t i = bad[k] % grid.size[0], j = bad[k] / grid.size[0] % grid.size[1];
      throw Error(ExitCode::bad_input, "",
                  "voxel " + std::to_string(i) + " " + std::to_string(j) + " " + std::to_string(k), "must be finite");
    }
    const InsideVoxels& p = planes[k];
    if (p.count == 0) continue;
    if (all.count == 0) all.box = p.box;
    for (int a = 0; a < 3; ++a) {
      all.box.begin[a] = std::min(all.box.begin[a], p.box.begin[a]);
      all.box.end[a] = std::max(all.box.end[a], p.box.end[a]);
    }
    all.count += p.count;
  }
  return all;
}

template <class T>
surface::TriMesh marching_cubes(const grid::Grid<T>& grid, double isovalue, const InsideVoxels& inside, double margin,
                                const Progress& progress) {
  surface::TriMesh mesh;
  if (inside.count == 0) return mesh;
  const Nodes<T> nodes(grid, isovalue, inside.box, margin);
  progress.report(0.2);
  const RowPoints rows = count_points(nodes);
  if (rows.total >= 0xffffffffu)
    throw refusal("contour", "more than 2^32 points", {"take larger voxels with `resample`"});
  progress.report(0.4);
  mesh.points_mm.resize(rows.total);
  parallel_for(0, nodes.size(2), 4, [&](std::int64_t from, std::int64_t to) {
    for (int k = static_cast<int>(from); k < to; ++k)
      for (int j = 0; j < nodes.size(1); ++j)
        for (int axis = 0; axis < 3; ++axis) {
          std::uint32_t n = rows.first[nodes.row(j, k)][axis];
          for_each_crossing(nodes, j, k, axis, [&](int i) { mesh.points_mm[n++] = nodes.point(i, j, k, axis); });
        }
  });
  progress.report(0.6);

  constexpr int slab = 4;
  const int layers = nodes.size(2) - 1;
  std::vector<std::vector<std::array<std::uint32_t, 3>>> slabs((layers + slab - 1) / slab);
  parallel_for(0, layers, slab, [&](std::int64_t from, std::int64_t to) {
    for (int k = static_cast<int>(from); k < to; ++k)
      for (int j = 0; j + 1 < nodes.size(1); ++j) cut_row(nodes, rows, j, k, slabs[from / slab]);
  });
  std::size_t total = 0;
  for (const auto& s : slabs) total += s.size();
  mesh.triangles.reserve(total);
  for (auto& s : slabs) {
    mesh.triangles.insert(mesh.triangles.end(), s.begin(), s.end());
    s = {};
  }
  progress.report(1);
  return mesh;
}

template InsideVoxels find_inside(const grid::Grid<std::int16_t>&, double);
template InsideVoxels find_inside(const grid::Grid<float>&, double);
template surface::TriMesh marching_cubes(const grid::Grid<std::int16_t>&, double, const InsideVoxels&, double,
                                         const Progress&);
template surface::TriMesh marching_cubes(const grid::Grid<float>&, double, const InsideVoxels&, double,
                                         const Progress&);

}  // namespace trephine::meshing
