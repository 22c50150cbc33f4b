// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/point_to_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <string>

#include "base/error.h"
#include "base/parallel.h"
#include "surface/bvh.h"
#include "surface/incidence.h"

namespace trephine::surface {
namespace {

constexpr std::int64_t piece = 2048;

const TriMesh& checked(const TriMesh& mesh) {
  check_mesh(mesh);
  if (mesh.triangles.empty())
    throw Error(ExitCode::bad_input, "", "surface", "has no triangles to measure a distance to");
  const auto small = [](Vec3 p) { return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) <= 1e15; };
  for (const auto& t : mesh.triangles)
    for (const std::uint32_t v : t)
      if (!small(mesh.points_mm[v]))
        throw Error(ExitCode::bad_input, "", "point " + std::to_string(v), "beyond 1e15 mm");
  return mesh;
}

double angle_at(Vec3 corner, Vec3 b, Vec3 c) {
  const Vec3 u = b - corner, v = c - corner;
  return std::atan2(norm(cross(u, v)), dot(u, v));
}

}  // namespace

struct PointToMesh::Impl {
  Impl(const TriMesh& m, const Progress& progress) : mesh(checked(m)), bvh(m, progress) {}

  const TriMesh& mesh;
  Bvh bvh;
  // Only the sign of a distance needs it.
  mutable std::once_flag once;
  mutable std::unique_ptr<const Incidence> incidence;

  Vec3 local(Vec3 world) const {
    if (!is_finite(world)) throw Error(ExitCode::bad_input, "", "point", "must be finite");
    return world - mesh.origin_mm;
  }

  ClosestPoint nearest(Vec3 world, std::uint32_t& triangle) const {
    return bvh.nearest(local(world), triangle, 0, triangle);
  }

  double squared_to(Vec3 local_mm, std::uint32_t triangle) const {
    const auto& t = mesh.triangles[triangle];
    return nearest_on_triangle(local_mm, mesh.points_mm[t[0]], mesh.points_mm[t[1]], mesh.points_mm[t[2]]).squared_mm2;
  }

  double distance(Vec3 world, std::uint32_t& triangle) const { return std::sqrt(nearest(world, triangle).squared_mm2); }

  double signed_distance(Vec3 world, std::uint32_t& triangle) const {
    const ClosestPoint c = nearest(world, triangle);
    const double d = std::sqrt(c.squared_mm2);
    return dot(local(world) - c.point, pseudonormal(triangle, c.feature)) < 0 ? -d : d;
  }

  Vec3 pseudonormal(std::uint32_t triangle, int feature) const {
    const Vec3 own = normalized(triangle_normal(mesh, triangle));
    if (feature == 6) return own;
    std::call_once(once, [&] { incidence = std::make_unique<const Incidence>(mesh); });
    const auto& t = mesh.triangles[triangle];
    const std::uint32_t corner = t[feature % 3];
    const auto from = incidence->triangle.begin() + incidence->begin[corner];
    const auto to = incidence->triangle.begin() + incidence->begin[corner + 1];
    Vec3 sum;
    for (auto it = from; it != to; ++it) {
      const auto& other = mesh.triangles[*it];
      const Vec3 n = normalized(triangle_normal(mesh, *it));
      if (feature < 3) {
        const auto at = std::size_t(std::find(other.begin(), other.end(), corner) - other.begin());
        sum += n * angle_at(mesh.points_mm[corner], mesh.points_mm[other[(at + 1) % 3]],
                            mesh.points_mm[other[(at + 2) % 3]]);
      } else if (std::find(other.begin(), other.end(), t[(feature + 1) % 3]) != other.end()) {
        sum += n;
      }
    }
    return sum == Vec3{} ? own : sum;
  }

  // Each piece begins its search for a point at the triangle that was nearest to the point before.
  template <class Each>
  void for_each(const std::vector<Vec3>& points, const Progress& progress, const Each& each) const {
    parallel_for(0, std::int64_t(points.size()), piece, [&](std::int64_t from, std::int64_t to) {
      progress.check();
      std::uint32_t triangle = 0;
      for (std::int64_t i = from; i < to; ++i) each(std::size_t(i), triangle);
    });
  }
};

PointToMesh::PointToMesh(const TriMesh& mesh, const Progress& progress)
    : impl_(std::make_unique<const Impl>(mesh, progress)) {}
PointToMesh::~PointToMesh() = default;
PointToMesh::PointToMesh(PointToMesh&&) noexcept = default;
PointToMesh& PointToMesh::operator=(PointToMesh&&) noexcept = default;

double PointToMesh::distance_mm(Vec3 world_mm) const {
  std::uint32_t triangle = 0;
  return impl_->distance(world_mm, triangle);
}

double PointToMesh::signed_distance_mm(Vec3 world_mm) const {
  std::uint32_t triangle = 0;
  return impl_->signed_distance(world_mm, triangle);
}

Vec3 PointToMesh::closest_mm(Vec3 world_mm) const {
  std::uint32_t triangle = 0;
  return impl_->mesh.origin_mm + impl_->nearest(world_mm, triangle).point;
}

std::vector<double> PointToMesh::distances_mm(const std::vector<Vec3>& world_mm, const Progress& progress) const {
  std::vector<double> d(world_mm.size());
  impl_->for_each(world_mm, progress,
                  [&](std::size_t i, std::uint32_t& triangle) { d[i] = impl_->distance(world_mm[i], triangle); });
  return d;
}

std::vector<double> PointToMesh::signed_distances_mm(const std::vector<Vec3>& world_mm,
                                                     const Progress& progress) const {
  std::vector<double> d(world_mm.size());
  impl_->for_each(world_mm, progress, [&](std::size_t i, std::uint32_t& triangle) {
    d[i] = impl_->signed_distance(world_mm[i], triangle);
  });
  return d;
}

double PointToMesh::largest_distance_mm(const std::vector<Vec3>& world_mm, double at_least_mm,
                                        const Progress& progress) const {
  // The search for a point ends as soon as it meets a triangle within the largest distance so far. Each piece keeps its
  // own largest distance.
  std::vector<double> largest((world_mm.size() + piece - 1) / piece, at_least_mm);
  parallel_for(0, std::int64_t(world_mm.size()), piece, [&](std::int64_t from, std::int64_t to) {
    progress.check();
    double& so_far = largest[std::size_t(from / piece)];
    // The points of a surface follow rows of voxels, which pass to and fro between opposite walls.
    std::array<std::uint32_t, 8> met{};
    std::size_t next = 0;
    const auto near_one_met = [&](Vec3 p) {
      for (const std::uint32_t t : met)
        if (impl_->squared_to(p, t) <= so_far * so_far) return true;
      return false;
    };
    for (std::int64_t i = from; i < to; ++i) {
      const Vec3 p = impl_->local(world_mm[std::size_t(i)]);
      if (near_one_met(p)) continue;
      std::uint32_t& triangle = met[next++ % met.size()];
      so_far = std::max(so_far, std::sqrt(impl_->bvh.nearest(p, triangle, so_far, triangle).squared_mm2));
    }
  });
  double result = at_least_mm;
  for (const double d : largest) result = std::max(result, d);
  return result;
}

}  // namespace trephine::surface
