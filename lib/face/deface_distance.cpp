// SPDX-License-Identifier: GPL-3.0-or-later
#include "face/deface_distance.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace trephine::face {

namespace {

constexpr float unknown_mm = 1e6f;

/// Half the extent of a voxel-sized box along n.
double reach_mm(const grid::Lattice& l, Vec3 n, Vec3 voxels) {
  double sum = 0;
  for (int a = 0; a < 3; ++a) sum += std::abs(dot(l.direction.column[a], n)) * l.spacing_mm[a] * voxels[a] / 2;
  return sum;
}

}  // namespace

grid::Box box_of(const FaceRegion& region, const grid::Lattice& lattice, double margin_mm) {
  // Blocks of 8 voxels a side that touch the region.
  constexpr int block = 8;
  grid::Box box{lattice.size, {0, 0, 0}};
  const Vec3 extent{block, block, block};
  const double along_front = reach_mm(lattice, region.front, extent) + margin_mm;
  const double along_up = reach_mm(lattice, region.up, extent) + margin_mm;
  for (int k = 0; k < lattice.size[2]; k += block)
    for (int j = 0; j < lattice.size[1]; j += block)
      for (int i = 0; i < lattice.size[0]; i += block) {
        const Vec3 p = lattice.to_world_mm({i + 0.5 * (block - 1), j + 0.5 * (block - 1), k + 0.5 * (block - 1)});
        if (region.in_front_mm(p) < -along_front || region.below_mm(p) < -along_up) continue;
        const int at[3] = {i, j, k};
        for (int a = 0; a < 3; ++a) {
          box.begin[a] = std::min(box.begin[a], at[a]);
          box.end[a] = std::max(box.end[a], std::min(at[a] + block, lattice.size[a]));
        }
      }
  return box.empty() ? grid::Box{} : box;
}

SkinDistance::SkinDistance(const grid::Field& field, const grid::Box& box, double step_mm, const Progress& progress) {
  nodes_ = field;
  nodes_.origin_mm = field.to_world_mm({double(box.begin[0]), double(box.begin[1]), double(box.begin[2])});
  for (int a = 0; a < 3; ++a) {
    voxels_[a] = std::max(1, int(step_mm / field.spacing_mm[a] + 1e-9));
    nodes_.spacing_mm[a] = voxels_[a] * field.spacing_mm[a];
    nodes_.size[a] = std::max(1, (box.end[a] - box.begin[a] - 1 + voxels_[a] - 1) / voxels_[a] + 1);
  }
  nearest_.assign(nodes_.count(), -1);
  distance_.assign(nodes_.count(), unknown_mm);
  find_points(field, box, progress.part(0, 0.4));
  sort_points();
  if (!points_.empty()) {
    sweep(1, progress);
    sweep(-1, progress);
  }
  signed_ = grid::Grid<float>(nodes_);
  for (int k = 0; k < nodes_.size[2]; ++k)
    for (int j = 0; j < nodes_.size[1]; ++j)
      for (int i = 0; i < nodes_.size[0]; ++i) {
        const std::size_t n = nodes_.index(i, j, k);
        const int at[3] = {box.begin[0] + i * voxels_[0], box.begin[1] + j * voxels_[1], box.begin[2] + k * voxels_[2]};
        // The last nodes may lie a little beyond the box: they continue it.
        int c[3];
        bool inside = true;
        for (int a = 0; a < 3; ++a) {
          c[a] = std::min(at[a], box.end[a] - 1);
          inside = inside && c[a] >= 0 && c[a] < field.size[a];
        }
        inside = inside && field.at(c[0], c[1], c[2]) > 0;
        signed_.voxels[n] = inside ? distance_[n] : -distance_[n];
      }
}

double SkinDistance::to_point_mm(const std::array<float, 3>& at, std::int32_t point) const {
  const std::array<float, 3>& p = points_[point];
  const float x = p[0] - at[0], y = p[1] - at[1], z = p[2] - at[2];
  return std::sqrt(x * x + y * y + z * z);
}

void SkinDistance::offer(std::size_t node, int i, int j, int k, std::int32_t point) {
  if (point < 0 || point == nearest_[node]) return;
  const Vec3& s = nodes_.spacing_mm;
  const float d = float(to_point_mm({float(i * s.x), float(j * s.y), float(k * s.z)}, point));
  if (d < distance_[node]) {
    distance_[node] = d;
    nearest_[node] = point;
  }
}

void SkinDistance::find_points(const grid::Field& field, const grid::Box& box, const Progress& progress) {
  grid::Box in = box;
  for (int a = 0; a < 3; ++a) {
    in.begin[a] = std::clamp(in.begin[a], 0, field.size[a]);
    in.end[a] = std::clamp(in.end[a], 0, field.size[a]);
  }
  if (in.empty()) return;
  const Vec3 s = field.spacing_mm;
  // Slice by slice, so that the order does not depend on the threads.
  std::vector<std::vector<std::array<float, 3>>> found(in.end[2] - in.begin[2]);
  parallel_for(in.begin[2], in.end[2], 4, [&](std::int64_t from, std::int64_t to) {
    progress.check();
    for (int k = int(from); k < to; ++k) {
      auto& out = found[k - in.begin[2]];
      const auto add = [&](double i, double j, double kk) {
        out.push_back(
            {float((i - box.begin[0]) * s.x), float((j - box.begin[1]) * s.y), float((kk - box.begin[2]) * s.z)});
      };
      for (int j = in.begin[1]; j < in.end[1]; ++j) {
        const float* row = &field.at(0, j, k);
        const float* next_j = j + 1 < in.end[1] ? &field.at(0, j + 1, k) : row;
        const float* next_k = k + 1 < in.end[2] ? &field.at(0, j, k + 1) : row;
        for (int i = in.begin[0]; i < in.end[0]; ++i) {
          const float f = row[i];
          const bool inside = f > 0;
          if (i + 1 < in.end[0] && inside != (row[i + 1] > 0)) add(i + f / (f - row[i + 1]), j, k);
          if (inside != (next_j[i] > 0)) add(i, j + f / (f - next_j[i]), k);
          if (inside != (next_k[i] > 0)) add(i, j, k + f / (f - next_k[i]));
        }
      }
    }
  });
  for (const auto& slice : found) points_.insert(points_.end(), slice.begin(), slice.end());
}

// Sorts the points by cells of the nodes, and offers each point to the nodes around its cell.
void SkinDistance::sort_points() {
  const auto cell_of = [&](const std::array<float, 3>& p, int(&at)[3]) {
    for (int a = 0; a < 3; ++a) at[a] = std::clamp(int(p[a] / nodes_.spacing_mm[a]), 0, nodes_.size[a] - 1);
    return nodes_.index(at[0], at[1], at[2]);
  };
  int at[3];
  bucket_.assign(nodes_.count() + 1, 0);
  for (const auto& p : points_) ++bucket_[cell_of(p, at) + 1];
  for (std::size_t n = 0; n < nodes_.count(); ++n) bucket_[n + 1] += bucket_[n];
  std::vector<std::array<float, 3>> sorted(points_.size());
  std::vector<std::uint32_t> next(bucket_.begin(), bucket_.end() - 1);
  for (const auto& p : points_) sorted[next[cell_of(p, at)]++] = p;
  points_ = std::move(sorted);
  for (std::size_t p = 0; p < points_.size(); ++p) {
    cell_of(points_[p], at);
    for (int k = at[2] - 1; k <= at[2] + 2; ++k)
      for (int j = at[1] - 1; j <= at[1] + 2; ++j)
        for (int i = at[0] - 1; i <= at[0] + 2; ++i)
          if (nodes_.contains(i, j, k)) offer(nodes_.index(i, j, k), i, j, k, std::int32_t(p));
  }
}

void SkinDistance::sweep(int direction, const Progress& progress) {
  const int nx = nodes_.size[0], ny = nodes_.size[1], nz = nodes_.size[2];
  for (int kk = 0; kk < nz; ++kk) {
    progress.check();
    const int k = direction > 0 ? kk : nz - 1 - kk;
    const bool has_k = k - direction >= 0 && k - direction < nz;
    for (int js : {1, -1})
      for (int jj = 0; jj < ny; ++jj) {
        const int j = js > 0 ? jj : ny - 1 - jj;
        const std::size_t row = nodes_.index(0, j, k);
        const std::int32_t* before_k = has_k && js > 0 ? &nearest_[nodes_.index(0, j, k - direction)] : nullptr;
        const std::int32_t* before_j = jj > 0 ? &nearest_[nodes_.index(0, j - js, k)] : nullptr;
        for (int i = 0; i < nx; ++i) {
          if (before_k) offer(row + i, i, j, k, before_k[i]);
          if (before_j) offer(row + i, i, j, k, before_j[i]);
          if (i == 0) continue;
          offer(row + i, i, j, k, nearest_[row + i - 1]);
          if (before_j) offer(row + i, i, j, k, before_j[i - 1]);
        }
        for (int i = nx - 2; i >= 0; --i) {
          offer(row + i, i, j, k, nearest_[row + i + 1]);
          if (before_j) offer(row + i, i, j, k, before_j[i + 1]);
        }
      }
  }
}

double SkinDistance::error_mm() const {
  double longest = 0;
  for (int a = 0; a < 3; ++a) longest = std::max(longest, nodes_.spacing_mm[a] / voxels_[a]);
  return 0.1 + std::hypot(face_clearance_mm, longest / 2) - face_clearance_mm;
}

std::array<float, 3> SkinDistance::local_mm(Vec3 index) const {
  const Vec3& s = nodes_.spacing_mm;
  return {float(index.x * s.x), float(index.y * s.y), float(index.z * s.z)};
}

// The nearest of the points that the nodes around a place know.
std::int32_t SkinDistance::guess(const std::array<float, 3>& at, Vec3 index) const {
  int begin[3], last[3];
  for (int a = 0; a < 3; ++a) {
    begin[a] = int(std::clamp(std::floor(index[a]), 0.0, double(nodes_.size[a] - 1)));
    last[a] = std::min(begin[a] + 1, nodes_.size[a] - 1);
  }
  std::int32_t best = -1;
  double least = unknown_mm;
  for (int k = begin[2]; k <= last[2]; ++k)
    for (int j = begin[1]; j <= last[1]; ++j)
      for (int i = begin[0]; i <= last[0]; ++i) {
        const std::int32_t point = nearest_[nodes_.index(i, j, k)];
        if (point < 0 || point == best) continue;
        const double d = to_point_mm(at, point);
        if (d < least) {
          least = d;
          best = point;
        }
      }
  return best;
}

double SkinDistance::about_mm(Vec3 world_mm) const {
  const Vec3 index = nodes_.to_index(world_mm);
  const auto at = local_mm(index);
  const std::int32_t point = guess(at, index);
  return point < 0 ? unknown_mm : to_point_mm(at, point);
}

double SkinDistance::distance_mm(Vec3 world_mm) const {
  const Vec3 index = nodes_.to_index(world_mm);
  const auto at = local_mm(index);
  const std::int32_t point = guess(at, index);
  if (point < 0) return unknown_mm;
  // The points in the cells beside it.
  int from[3], to[3];
  for (int a = 0; a < 3; ++a) {
    const int cell = std::clamp(int(points_[point][a] / nodes_.spacing_mm[a]), 0, nodes_.size[a] - 1);
    from[a] = std::max(cell - 1, 0);
    to[a] = std::min(cell + 1, nodes_.size[a] - 1);
  }
  double least = to_point_mm(at, point);
  for (int k = from[2]; k <= to[2]; ++k)
    for (int j = from[1]; j <= to[1]; ++j) {
      // The cells of a row lie behind each other.
      const std::uint32_t end = bucket_[nodes_.index(to[0], j, k) + 1];
      for (std::uint32_t p = bucket_[nodes_.index(from[0], j, k)]; p < end; ++p)
        least = std::min(least, to_point_mm(at, std::int32_t(p)));
    }
  return least;
}

}  // namespace trephine::face
