// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/repair_winding.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "base/parallel.h"
#include "meshing/contour.h"
#include "surface/bounds.h"
#include "surface/point_to_mesh.h"

namespace trephine::meshing {
namespace {

/// The solid angle of the triangle as seen from p, divided by 4 pi [VanOosterom1983].
double solid_angle(Vec3 a, Vec3 b, Vec3 c, Vec3 p) {
  a = a - p;
  b = b - p;
  c = c - p;
  const double la = norm(a), lb = norm(b), lc = norm(c);
  return std::atan2(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb) / (2 * M_PI);
}

constexpr std::uint32_t leaf_size = 8;
constexpr double far_factor = 2;
constexpr int block = 8;           // voxels
constexpr double band = 3;         // voxels beside the triangles that get their distance
constexpr double free_slope = 10;  // voxels a unit of winding number where there is no triangle near

class Recontour {
 public:
  Recontour(const surface::TriMesh& mesh, int voxels_count) : mesh_(mesh), winding_(mesh), distance_(mesh) {
    surface::Bounds box;
    for (const auto& t : mesh.triangles)
      for (const std::uint32_t v : t) surface::include(box, mesh.points_mm[v]);
    const Vec3 lo = box.min_mm, hi = box.max_mm;
    side_ = std::max({hi.x - lo.x, hi.y - lo.y, hi.z - lo.z}) / voxels_count;
    // The raster is placed independently of the surface, so facets that lie on a raster plane do no harm.
    lo_ = lo - Vec3{3.37, 3.41, 3.29} * side_;
    field_.spacing_mm = {side_, side_, side_};
    field_.origin_mm = mesh.origin_mm + lo_;
    for (int a = 0; a < 3; ++a) {
      field_.size[a] = int(std::ceil((hi[a] - lo[a]) / side_)) + 8;
      blocks_[a] = (field_.size[a] + block - 1) / block;
    }
    field_.voxels.assign(field_.count(), 0);
  }

  surface::TriMesh run(const Progress& progress) {
    find_corners(progress.part(0, 0.2));
    mark_near();
    for (int k = 0; k < blocks_[2]; ++k) {
      progress.report(0.2 + 0.6 * k / blocks_[2]);
      fill_slab(k, progress);
    }
    ContourParams params;
    params.min_component_mm3 = 4 * side_ * side_ * side_;
    params.keep_cavities = true;
    return contour(field_, params, progress.part(0.8, 1)).value;
  }
  double side_mm() const { return side_; }

 private:
  Vec3 local(int i, int j, int k) const { return lo_ + Vec3{double(i), double(j), double(k)} * side_; }
  std::size_t corner(int i, int j, int k) const {
    return (std::size_t(k) * (blocks_[1] + 1) + j) * (blocks_[0] + 1) + i;
  }
  std::size_t block_at(int i, int j, int k) const { return (std::size_t(k) * blocks_[1] + j) * blocks_[0] + i; }

  void find_corners(const Progress& progress) {
    corners_.resize(corner(blocks_[0], blocks_[1], blocks_[2]) + 1);
    parallel_for(0, blocks_[2] + 1, 1, [&](std::int64_t from, std::int64_t to) {
      for (int k = int(from); k < to; ++k) {
        progress.check();
        for (int j = 0; j <= blocks_[1]; ++j)
          for (int i = 0; i <= blocks_[0]; ++i)
            corners_[corner(i, j, k)] = float(winding_.at(local(i * block, j * block, k * block)));
      }
    });
  }

  void mark_near() {
    near_.assign(block_at(blocks_[0] - 1, blocks_[1] - 1, blocks_[2] - 1) + 1, 0);
    for (const auto& t : mesh_.triangles) {
      int lo[3], hi[3];
      for (int a = 0; a < 3; ++a) {
        const double p = mesh_.points_mm[t[0]][a], q = mesh_.points_mm[t[1]][a], r = mesh_.points_mm[t[2]][a];
        lo[a] = std::max(0, int(((std::min({p, q, r}) - lo_[a]) / side_ - band) / block));
        hi[a] = std::min(blocks_[a] - 1, int(((std::max({p, q, r}) - lo_[a]) / side_ + band) / block));
      }
      for (int k = lo[2]; k <= hi[2]; ++k)
        for (int j = lo[1]; j <= hi[1]; ++j)
          for (int i = lo[0]; i <= hi[0]; ++i) near_[block_at(i, j, k)] = 1;
    }
  }

  bool unsure(int i, int j, int k) const {
    bool all_out = true, all_in = true;
    for (int c = 0; c < 8; ++c) {
      const float w = corners_[corner(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2 & 1))];
      all_out &= w < 0.3f;
      all_in &= w > 0.7f;
    }
    return !all_out && !all_in;
  }

  void fill_slab(int k, const Progress& progress) {
    std::vector<std::size_t> index;
    std::vector<Vec3> points;
    for (int j = 0; j < blocks_[1]; ++j)
      for (int i = 0; i < blocks_[0]; ++i) {
        const bool near = near_[block_at(i, j, k)], work = near || unsure(i, j, k);
        const auto plain = float((corners_[corner(i, j, k)] - 0.5) * free_slope * side_);
        for (int z = k * block; z < std::min((k + 1) * block, field_.size[2]); ++z)
          for (int y = j * block; y < std::min((j + 1) * block, field_.size[1]); ++y)
            for (int x = i * block; x < std::min((i + 1) * block, field_.size[0]); ++x) {
              const std::size_t n = field_.index(x, y, z);
              field_.voxels[n] = plain;
              if (!work) continue;
              index.push_back(n);
              points.push_back(local(x, y, z));
            }
      }
    std::vector<Vec3> world(points.size());
    for (std::size_t n = 0; n < points.size(); ++n) world[n] = points[n] + mesh_.origin_mm;
    const std::vector<double> distance = distance_.distances_mm(world, progress);
    parallel_for(0, std::int64_t(index.size()), 1024, [&](std::int64_t from, std::int64_t to) {
      progress.check();
      for (std::int64_t n = from; n < to; ++n) {
        const double w = winding_.at(points[n]) - 0.5;
        const double reach = std::min(distance[n], std::abs(w) * free_slope * side_);
        field_.voxels[index[n]] = float(w > 0 ? reach : -reach);
      }
    });
  }

  const surface::TriMesh& mesh_;
  WindingNumber winding_;
  surface::PointToMesh distance_;
  double side_ = 0;
  Vec3 lo_;
  grid::Field field_;
  int blocks_[3];
  std::vector<float> corners_;
  std::vector<char> near_;
};

}  // namespace

double winding_number(const surface::TriMesh& mesh, Vec3 p) {
  double sum = 0;
  for (const auto& t : mesh.triangles)
    sum += solid_angle(mesh.points_mm[t[0]], mesh.points_mm[t[1]], mesh.points_mm[t[2]], p);
  return sum;
}

WindingNumber::WindingNumber(const surface::TriMesh& mesh) : mesh_(mesh), order_(mesh.triangles.size()) {
  std::iota(order_.begin(), order_.end(), 0u);
  for (const auto& t : mesh.triangles)
    middle_.push_back((mesh.points_mm[t[0]] + mesh.points_mm[t[1]] + mesh.points_mm[t[2]]) / 3);
  if (!order_.empty()) build(0, static_cast<std::uint32_t>(order_.size()));
}

std::uint32_t WindingNumber::build(std::uint32_t begin, std::uint32_t end) {
  const auto index = static_cast<std::uint32_t>(nodes_.size());
  Node node;
  node.begin = begin;
  node.end = end;
  surface::Bounds box;
  double total = 0;
  for (std::uint32_t n = begin; n < end; ++n) {
    const Vec3 normal = surface::triangle_normal(mesh_, order_[n]) / 2;
    const double area = norm(normal);
    node.area_normal += normal;
    node.centre += middle_[order_[n]] * area;
    total += area;
    surface::include(box, middle_[order_[n]]);
  }
  const Vec3 lo = box.min_mm, hi = box.max_mm;
  node.centre = total > 0 ? node.centre / total : (lo + hi) / 2;
  for (std::uint32_t n = begin; n < end; ++n)
    for (const std::uint32_t v : mesh_.triangles[order_[n]])
      node.radius = std::max(node.radius, norm(mesh_.points_mm[v] - node.centre));
  nodes_.push_back(node);
  if (end - begin > leaf_size) {
    const Vec3 size = hi - lo;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const std::uint32_t half = begin + (end - begin) / 2;
    std::nth_element(order_.begin() + begin, order_.begin() + half, order_.begin() + end,
                     [&](std::uint32_t a, std::uint32_t b) {
                       return middle_[a][axis] != middle_[b][axis] ? middle_[a][axis] < middle_[b][axis] : a < b;
                     });
    const std::uint32_t left = build(begin, half), right = build(half, end);
    nodes_[index].left = left;
    nodes_[index].right = right;
  }
  return index;
}

double WindingNumber::at(Vec3 p) const {
  if (nodes_.empty()) return 0;
  double sum = 0;
  std::array<std::uint32_t, 128> stack;
  int top = 0;
  stack[top++] = 0;
  while (top > 0) {
    const Node& node = nodes_[stack[--top]];
    const Vec3 r = node.centre - p;
    const double d = norm(r);
    if (d > far_factor * node.radius) {
      sum += dot(node.area_normal, r) / (d * d * d * 4 * M_PI);
    } else if (node.left == 0) {
      for (std::uint32_t n = node.begin; n < node.end; ++n) {
        const auto& t = mesh_.triangles[order_[n]];
        sum += solid_angle(mesh_.points_mm[t[0]], mesh_.points_mm[t[1]], mesh_.points_mm[t[2]], p);
      }
    } else {
      stack[top++] = node.right;
      stack[top++] = node.left;
    }
  }
  return sum;
}

surface::TriMesh recontour(const surface::TriMesh& mesh, int voxels_count, double& voxel_mm, const Progress& progress) {
  Recontour work(mesh, voxels_count);
  voxel_mm = work.side_mm();
  return work.run(progress);
}

}  // namespace trephine::meshing
