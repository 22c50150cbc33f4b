// SPDX-License-Identifier: GPL-3.0-or-later
// The only file that includes CGAL's repairs, because they take long to compile. They may crash or hang, so they run in
// the bounded child process.
#include "meshing/repair_child.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/border.h>
#include <CGAL/Polygon_mesh_processing/connected_components.h>
#include <CGAL/Polygon_mesh_processing/corefinement.h>
#include <CGAL/Polygon_mesh_processing/repair_degeneracies.h>
#include <CGAL/Polygon_mesh_processing/repair_self_intersections.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Polygon_mesh_processing/stitch_borders.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/Surface_mesh.h>

#include <array>
#include <map>
#include <set>
#include <vector>

#include "base/child.h"
#include "base/child_message.h"
#include "base/disjoint_sets.h"
#include "base/error.h"
#include "base/refusal.h"

namespace trephine::meshing {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
using Face = Mesh::Face_index;
namespace Pmp = CGAL::Polygon_mesh_processing;
using Triangle = std::array<std::uint32_t, 3>;

constexpr const char* worker_name = "meshing-mend";

Mesh to_cgal(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles) {
  Mesh m;
  for (const Vec3 p : points) m.add_vertex({p.x, p.y, p.z});
  for (const auto& t : triangles)
    if (m.add_face(Mesh::Vertex_index(t[0]), Mesh::Vertex_index(t[1]), Mesh::Vertex_index(t[2])) == Mesh::null_face())
      throw refusal("", "is not 2-manifold", {"set `recontour_voxels_count` for a new surface through voxels"});
  return m;
}

void from_cgal(const Mesh& m, std::vector<Vec3>& points, std::vector<Triangle>& triangles) {
  std::vector<std::uint32_t> index(m.num_vertices() + m.number_of_removed_vertices());
  for (const auto v : m.vertices()) {
    const auto& p = m.point(v);
    index[v] = std::uint32_t(points.size());
    points.push_back({p.x(), p.y(), p.z()});
  }
  for (const auto f : m.faces()) {
    Triangle t{};
    int c = 0;
    for (const auto v : m.vertices_around_face(m.halfedge(f))) t[c++] = index[v];
    triangles.push_back(t);
  }
}

std::int64_t fill_holes(Mesh& m) {
  std::vector<Mesh::Halfedge_index> cycles;
  Pmp::extract_boundary_cycles(m, std::back_inserter(cycles));
  std::int64_t filled = 0;
  for (const auto h : cycles) {
    if (m.is_removed(h) || !m.is_border(h)) continue;
    std::vector<Face> patch;
    Pmp::triangulate_hole(m, h, std::back_inserter(patch));
    filled += !patch.empty();
  }
  return filled;
}

double height2(const Mesh& m, Face f) {
  std::array<Kernel::Point_3, 3> p;
  int c = 0;
  for (const auto v : m.vertices_around_face(m.halfedge(f))) p[c++] = m.point(v);
  const double longest = std::max(
      {CGAL::squared_distance(p[0], p[1]), CGAL::squared_distance(p[1], p[2]), CGAL::squared_distance(p[2], p[0])});
  return longest > 0 ? 4 * CGAL::squared_area(p[0], p[1], p[2]) / longest : 0;
}

void collapse_slivers(Mesh& m, double flattest) {
  std::vector<Face> flat;
  for (const auto f : m.faces())
    if (height2(m, f) < flattest * flattest) flat.push_back(f);
  if (!flat.empty())
    Pmp::experimental::remove_almost_degenerate_faces(flat, m, std::cos(160. / 180 * CGAL_PI), 4., 10 * flattest);
}

using Pairs = std::vector<std::pair<Face, Face>>;

Pairs crossing(const Mesh& m) {
  Pairs pairs;
  Pmp::self_intersections<CGAL::Sequential_tag>(m.faces(), m, std::back_inserter(pairs));
  return pairs;
}

/// Unites pieces that meet. Returns how many were united with another one.
std::int64_t unite(Mesh& m) {
  auto label = m.add_property_map<Face, std::size_t>("f:piece", 0).first;
  const std::size_t count = Pmp::connected_components(m, label);
  DisjointSets groups(count);
  for (const auto& [a, b] : crossing(m)) groups.unite(std::uint32_t(label[a]), std::uint32_t(label[b]));
  std::vector<std::vector<std::size_t>> members(count);
  for (std::uint32_t i = 0; i < count; ++i) members[groups.find(i)].push_back(i);
  std::vector<Mesh> pieces(count);
  std::vector<std::map<std::uint32_t, Mesh::Vertex_index>> vertex(count);
  for (const auto f : m.faces()) {
    const std::size_t piece = label[f];
    std::array<Mesh::Vertex_index, 3> v;
    int c = 0;
    for (const auto u : m.vertices_around_face(m.halfedge(f))) {
      const auto [at, fresh] = vertex[piece].try_emplace(std::uint32_t(u));
      if (fresh) at->second = pieces[piece].add_vertex(m.point(u));
      v[c++] = at->second;
    }
    pieces[piece].add_face(v[0], v[1], v[2]);
  }
  std::int64_t united = 0;
  Mesh whole;
  for (const auto& all : members) {
    if (all.empty()) continue;
    Mesh sum = pieces[all[0]];
    for (std::size_t i = 1; i < all.size(); ++i) {
      if (!Pmp::corefine_and_compute_union(sum, pieces[all[i]], sum,
                                           CGAL::parameters::throw_on_self_intersection(true)))
        throw refusal("", "the union of its pieces is no 2-manifold",
                      {"set `recontour_voxels_count` for a new surface through voxels"});
      ++united;
    }
    whole += sum;
  }
  m = whole;
  return united;
}

const ChildWorker worker(worker_name, [](ChildRequest& request) {
  MessageReader in(worker_name, request.request());
  const auto points = in.array<Vec3>();
  const auto triangles = in.array<Triangle>();
  const double flattest = in.array<double>().at(0);
  Mesh m = to_cgal(points, triangles);
  std::vector<std::int64_t> counts(4, 0);
  auto &holes = counts[0], &degenerate = counts[1], &crossings = counts[2], &united = counts[3];

  Pmp::stitch_borders(m);
  const auto before = std::int64_t(m.number_of_faces());
  Pmp::remove_degenerate_faces(m);
  degenerate = std::max<std::int64_t>(0, before - std::int64_t(m.number_of_faces()));
  holes = fill_holes(m);
  collapse_slivers(m, flattest);
  Pmp::remove_degenerate_faces(m);
  holes += fill_holes(m);
  request.report(0.3);
  const Pairs pairs = crossing(m);
  crossings = std::int64_t(pairs.size());
  if (!pairs.empty()) {
    // Only self-intersections within one piece: where two pieces cross, cutting and filling would damage both.
    Pmp::experimental::remove_self_intersections(
        m, CGAL::parameters::preserve_genus(false).apply_per_connected_component(false).number_of_iterations(10));
    holes += fill_holes(m);
    request.report(0.6);
    if (CGAL::is_closed(m)) united = unite(m);
  }
  if (!CGAL::is_closed(m))
    throw refusal("", "a hole cannot be filled", {"set `recontour_voxels_count` for a new surface through voxels"});

  std::vector<Vec3> out_points;
  std::vector<Triangle> out_triangles;
  m.collect_garbage();
  from_cgal(m, out_points, out_triangles);
  MessageWriter out;
  out.array(out_points);
  out.array(out_triangles);
  out.array(counts);
  request.write(out.bytes());
});

}  // namespace

Mended mend(const surface::TriMesh& mesh, double flattest_mm, double time_limit_s, const Progress& progress) {
  MessageWriter request;
  request.array(mesh.points_mm);
  request.array(mesh.triangles);
  request.array(std::vector<double>{flattest_mm});
  ChildLimits limits;
  limits.memory_bytes = (std::uint64_t{3} << 30) + 8192 * mesh.triangles.size();
  limits.wall_s = time_limit_s;
  limits.cpu_s = 4 * time_limit_s + 10;
  Mended mended;
  mended.mesh.origin_mm = mesh.origin_mm;
  try {
    const ChildResult result = run_child(worker_name, request.bytes(), limits, progress);
    MessageReader in(worker_name, result.bytes());
    mended.mesh.points_mm = in.array<Vec3>();
    mended.mesh.triangles = in.array<Triangle>();
    const auto counts = in.array<std::int64_t>();
    mended.holes = counts.at(0);
    mended.degenerate = counts.at(1);
    mended.self_intersections = counts.at(2);
    mended.united = counts.at(3);
    surface::check_mesh(mended.mesh);
  } catch (const Error& e) {
    mended.fault = e.what();
    mended.over_limit = e.cause() == Cause::child_limit;
  }
  return mended;
}

}  // namespace trephine::meshing
