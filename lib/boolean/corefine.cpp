// SPDX-License-Identifier: GPL-3.0-or-later
// The only file with CGAL's corefinement: seconds to compile, and it may crash, so that it runs in the bounded child.
#include "boolean/corefine.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/corefinement.h>
#include <CGAL/Surface_mesh.h>

#include <algorithm>
#include <array>
#include <map>
#include <numeric>

#include "base/child.h"
#include "base/child_message.h"
#include "base/error.h"
#include "base/refusal.h"

namespace trephine::boolean {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
namespace Pmp = CGAL::Polygon_mesh_processing;

constexpr const char* worker_name = "boolean-corefine";
using Triangle = std::array<std::uint32_t, 3>;

Mesh to_cgal(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles) {
  Mesh m;
  m.reserve(Mesh::size_type(points.size()), Mesh::size_type(3 * triangles.size() / 2),
            Mesh::size_type(triangles.size()));
  for (const Vec3 p : points) m.add_vertex({p.x, p.y, p.z});
  for (const auto& t : triangles)
    if (m.add_face(Mesh::Vertex_index(t[0]), Mesh::Vertex_index(t[1]), Mesh::Vertex_index(t[2])) == Mesh::null_face())
      throw refusal("", "an operand is not 2-manifold", {"mend it with `repair`"});
  return m;
}

Triangle rotated(Triangle t) {
  std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  return t;
}

const ChildWorker worker(worker_name, [](ChildRequest& request) {
  MessageReader in(worker_name, request.request());
  const auto points = in.array<Vec3>();
  const auto triangles = in.array<Triangle>();
  const auto solid_points = in.array<Vec3>();
  const auto solid_triangles = in.array<Triangle>();
  Mesh surface = to_cgal(points, triangles), solid = to_cgal(solid_points, solid_triangles);
  if (!Pmp::corefine_and_compute_difference(surface, solid, surface,
                                            CGAL::parameters::throw_on_self_intersection(true)))
    throw refusal("", "the difference is no 2-manifold", {"move the cutter a little by `position_mm`"});

  std::vector<Vec3> out_points;
  std::vector<std::uint32_t> old_point, old_triangle,
      index(surface.num_vertices() + surface.number_of_removed_vertices());
  for (const auto v : surface.vertices()) {
    const auto& p = surface.point(v);
    index[v] = std::uint32_t(out_points.size());
    out_points.push_back({p.x(), p.y(), p.z()});
    old_point.push_back(std::size_t(v) < points.size() && points[v] == out_points.back() ? std::uint32_t(v)
                                                                                         : Difference::none);
  }
  std::vector<Triangle> out_triangles;
  for (const auto f : surface.faces()) {
    Triangle t, was{};
    int c = 0;
    for (const auto v : surface.vertices_around_face(surface.halfedge(f))) {
      was[c] = std::uint32_t(v);
      t[c++] = index[v];
    }
    const bool same = std::size_t(f) < triangles.size() && rotated(was) == rotated(triangles[f]);
    out_triangles.push_back(t);
    old_triangle.push_back(same ? std::uint32_t(f) : Difference::none);
  }
  MessageWriter out;
  out.array(out_points);
  out.array(old_point);
  out.array(out_triangles);
  out.array(old_triangle);
  request.write(out.bytes());
});

bool before(Vec3 a, Vec3 b) { return std::array{a.x, a.y, a.z} < std::array{b.x, b.y, b.z}; }

/// The order of the result is ours, whatever CGAL's.
Difference ordered(const std::vector<Vec3>& points, const std::vector<std::uint32_t>& old_point,
                   const std::vector<Triangle>& triangles, const std::vector<std::uint32_t>& old_triangle) {
  Difference d;
  std::vector<std::uint32_t> order(points.size()), place(points.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return old_point[a] != old_point[b] ? old_point[a] < old_point[b] : before(points[a], points[b]);
  });
  for (std::uint32_t i = 0; i < order.size(); ++i) {
    place[order[i]] = i;
    d.mesh.points_mm.push_back(points[order[i]]);
    d.old_point.push_back(old_point[order[i]]);
  }
  struct Item {
    std::uint32_t old;
    Triangle t;
  };
  std::vector<Item> items;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    Triangle t;
    for (int c = 0; c < 3; ++c) {
      if (triangles[i][c] >= place.size())
        throw Error(ExitCode::internal, "", worker_name, "the child sent a triangle without points");
      t[c] = place[triangles[i][c]];
    }
    items.push_back({old_triangle[i], rotated(t)});
  }
  std::sort(items.begin(), items.end(),
            [](const Item& a, const Item& b) { return a.old != b.old ? a.old < b.old : a.t < b.t; });
  for (const Item& i : items) {
    d.mesh.triangles.push_back(i.t);
    d.old_triangle.push_back(i.old);
  }
  return d;
}

}  // namespace

Difference corefine_difference(const surface::TriMesh& surface, const surface::TriMesh& solid, double time_limit_s,
                               const Progress& progress) {
  std::vector<Vec3> solid_points;
  for (std::size_t i = 0; i < solid.points_mm.size(); ++i)
    solid_points.push_back(solid.points_mm[i] + (solid.origin_mm - surface.origin_mm));
  MessageWriter request;
  request.array(surface.points_mm);
  request.array(surface.triangles);
  request.array(solid_points);
  request.array(solid.triangles);

  ChildLimits limits;
  limits.memory_bytes = (std::uint64_t{3} << 30) + 4096 * (surface.triangles.size() + solid.triangles.size());
  limits.wall_s = time_limit_s;
  limits.cpu_s = 16 * time_limit_s + 10;
  try {
    const ChildResult result = run_child(worker_name, request.bytes(), limits, progress);
    MessageReader in(worker_name, result.bytes());
    const auto points = in.array<Vec3>();
    const auto old_point = in.array<std::uint32_t>();
    const auto triangles = in.array<Triangle>();
    const auto old_triangle = in.array<std::uint32_t>();
    if (old_point.size() != points.size() || old_triangle.size() != triangles.size())
      throw Error(ExitCode::internal, "", worker_name, "the child's result contradicts itself");
    Difference d = ordered(points, old_point, triangles, old_triangle);
    d.mesh.origin_mm = surface.origin_mm;
    return d;
  } catch (const Error& e) {
    if (e.cause() == Cause::child_limit) throw;  // of time or memory: another try would meet it too
    Difference d;
    d.fault = e.what();
    return d;
  }
}

}  // namespace trephine::boolean
