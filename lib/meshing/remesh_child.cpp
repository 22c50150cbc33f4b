// SPDX-License-Identifier: GPL-3.0-or-later
// The only file that includes CGAL's remeshing, because it takes long to compile. It may crash, so it runs in the
// bounded child process.
#include "meshing/remesh_child.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/detect_features.h>
#include <CGAL/Polygon_mesh_processing/remesh.h>
#include <CGAL/Surface_mesh.h>

#include <array>
#include <vector>

#include "base/child.h"
#include "base/child_message.h"
#include "base/error.h"
#include "base/refusal.h"

namespace trephine::meshing {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
namespace Pmp = CGAL::Polygon_mesh_processing;
using Triangle = std::array<std::uint32_t, 3>;

constexpr const char* worker_name = "meshing-remesh";

const ChildWorker worker(worker_name, [](ChildRequest& request) {
  MessageReader in(worker_name, request.request());
  const auto points = in.array<Vec3>();
  const auto triangles = in.array<Triangle>();
  const auto numbers = in.array<double>();
  const double edge = numbers.at(0), angle = numbers.at(2);
  const auto iterations = static_cast<unsigned>(numbers.at(1));
  Mesh m;
  for (const Vec3 p : points) m.add_vertex({p.x, p.y, p.z});
  for (const auto& t : triangles)
    if (m.add_face(Mesh::Vertex_index(t[0]), Mesh::Vertex_index(t[1]), Mesh::Vertex_index(t[2])) == Mesh::null_face())
      throw refusal("", "is not 2-manifold", {"mend it with `repair`"});
  auto sharp = m.add_property_map<Mesh::Edge_index, bool>("e:sharp", false).first;
  if (angle < 180) Pmp::detect_sharp_edges(m, angle, sharp);
  if (angle < 180) Pmp::split_long_edges(m.edges(), 4. / 3 * edge, m, CGAL::parameters::edge_is_constrained_map(sharp));
  Pmp::isotropic_remeshing(
      m.faces(), edge, m,
      CGAL::parameters::number_of_iterations(iterations).protect_constraints(false).edge_is_constrained_map(sharp));
  m.collect_garbage();
  std::vector<Vec3> out_points;
  std::vector<Triangle> out_triangles;
  for (const auto v : m.vertices()) out_points.push_back({m.point(v).x(), m.point(v).y(), m.point(v).z()});
  for (const auto f : m.faces()) {
    Triangle t{};
    int c = 0;
    for (const auto v : m.vertices_around_face(m.halfedge(f))) t[c++] = std::uint32_t(v);
    out_triangles.push_back(t);
  }
  MessageWriter out;
  out.array(out_points);
  out.array(out_triangles);
  request.write(out.bytes());
});

}  // namespace

surface::TriMesh remesh_evenly(const surface::TriMesh& mesh, double edge_mm, std::int64_t iterations,
                               double feature_angle_deg, double time_limit_s, const Progress& progress) {
  MessageWriter request;
  request.array(mesh.points_mm);
  request.array(mesh.triangles);
  request.array(std::vector<double>{edge_mm, double(iterations), feature_angle_deg});
  ChildLimits limits;
  limits.memory_bytes = std::uint64_t{16} << 30;
  limits.wall_s = time_limit_s;
  limits.cpu_s = 4 * time_limit_s + 10;
  const ChildResult result = run_child(worker_name, request.bytes(), limits, progress);
  MessageReader in(worker_name, result.bytes());
  surface::TriMesh out;
  out.origin_mm = mesh.origin_mm;
  out.points_mm = in.array<Vec3>();
  out.triangles = in.array<Triangle>();
  surface::check_mesh(out);
  return out;
}

}  // namespace trephine::meshing
