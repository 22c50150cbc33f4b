// SPDX-License-Identifier: GPL-3.0-or-later
// Contour and decimation beside the libraries', in one run: bench_decimate VOLUME.nrrd [isovalue_hu [triangles
// [bound_mm]]]. The surface is the volume's largest piece at the isovalue. Times are wall clock, so run it on an idle
// machine.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Bounded_normal_change_filter.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Count_stop_predicate.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/GarlandHeckbert_policies.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>
#include <vtkFlyingEdges3D.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkShortArray.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>

#include "base/error.h"
#include "grid/nrrd.h"
#include "meshing/contour.h"
#include "meshing/decimate.h"
#include "meshing/marching_cubes.h"
#include "meshing/validity.h"
#include "metrics/deviation.h"

using namespace trephine;

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using CgalMesh = CGAL::Surface_mesh<Kernel::Point_3>;
namespace Sms = CGAL::Surface_mesh_simplification;

double timed(const std::function<void()>& f) {
  const auto start = std::chrono::steady_clock::now();
  f();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

TriMesh by_cgal(const TriMesh& mesh, std::size_t triangles, double& seconds) {
  CgalMesh m;
  for (const Vec3 p : mesh.points_mm) m.add_vertex({p.x, p.y, p.z});
  for (const auto& t : mesh.triangles)
    m.add_face(CgalMesh::Vertex_index(t[0]), CgalMesh::Vertex_index(t[1]), CgalMesh::Vertex_index(t[2]));
  seconds = timed([&] {
    using Policies = Sms::GarlandHeckbert_plane_policies<CgalMesh, Kernel>;
    const Policies policies(m);
    Sms::Bounded_normal_change_filter<> filter;
    Sms::Count_stop_predicate<CgalMesh> stop(3 * triangles / 2);
    Sms::edge_collapse(
        m, stop,
        CGAL::parameters::get_cost(policies.get_cost()).get_placement(policies.get_placement()).filter(filter));
  });
  m.collect_garbage();
  TriMesh out;
  out.origin_mm = mesh.origin_mm;
  for (const auto v : m.vertices()) out.points_mm.push_back({m.point(v).x(), m.point(v).y(), m.point(v).z()});
  for (const auto f : m.faces()) {
    std::array<std::uint32_t, 3> t{};
    int c = 0;
    for (const auto v : m.vertices_around_face(m.halfedge(f))) t[c++] = static_cast<std::uint32_t>(v);
    out.triangles.push_back(t);
  }
  return out;
}

void print_row(const char* name, double seconds, const TriMesh& mesh, const TriMesh& input) {
  const Validity v = check_validity(mesh);
  const Deviation d = measure_deviation(mesh, input);
  std::printf("%-28s %7.2f s %8zu  open %zu  non-manifold %zu  intersecting %zu  RMS %.4f  p99 %.4f  max %.4f mm\n",
              name, seconds, mesh.triangles.size(), v.topology.boundary_edges,
              v.topology.nonmanifold_edges + v.topology.nonmanifold_points, v.self_intersections, d.both.rms_mm,
              d.both.p99_mm, d.both.max_mm);
}

void contours(const Grid<std::int16_t>& grid, double isovalue) {
  TriMesh ours;
  const double seconds =
      timed([&] { ours = marching_cubes(grid, isovalue, find_inside(grid, isovalue), 0.002, Progress()); });
  std::printf("%-28s %7.2f s %8zu\n", "marching cubes, ours", seconds, ours.triangles.size());
  vtkNew<vtkImageData> image;
  image->SetDimensions(grid.size.data());
  vtkNew<vtkShortArray> samples;
  samples->SetArray(const_cast<short*>(grid.voxels.data()), static_cast<vtkIdType>(grid.voxels.size()), 1);
  image->GetPointData()->SetScalars(samples);
  vtkNew<vtkFlyingEdges3D> edges;
  edges->SetInputData(image);
  edges->ComputeNormalsOff();
  edges->ComputeScalarsOff();
  edges->SetValue(0, isovalue);
  const double theirs = timed([&] { edges->Update(); });
  std::printf("%-28s %7.2f s %8lld\n", "vtkFlyingEdges3D (not padded)", theirs,
              static_cast<long long>(edges->GetOutput()->GetNumberOfPolys()));
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 2) return std::fprintf(stderr, "bench_decimate VOLUME.nrrd [isovalue_hu [triangles [bound_mm]]]\n"), 64;
  const HuVolume volume = read_hu_nrrd(argv[1]);
  ContourParams c;
  c.isovalue_hu = argc > 2 ? std::atof(argv[2]) : 226.5;
  c.min_component_mm3 = 1e9;
  if (const auto* grid = std::get_if<Grid<std::int16_t>>(&volume)) contours(*grid, c.isovalue_hu);
  Report report;
  TriMesh input;
  const double seconds = timed([&] { input = contour(volume, c, report); });
  std::printf("%-28s %7.2f s %8zu\n", "contour, checked", seconds, input.triangles.size());

  const std::size_t count = argc > 3 ? std::strtoul(argv[3], nullptr, 10) : 80000;
  DecimateParams d;
  d.target_triangles_count = static_cast<std::int64_t>(count);
  for (const double bound : {0.0, argc > 4 ? std::atof(argv[4]) : 0.3}) {
    d.max_deviation_mm = bound;
    TriMesh out;
    const double s = timed([&] {
      Report r;
      out = decimate(input, d, r);
    });
    print_row(bound > 0 ? "decimate, count and bound" : "decimate, count only", s, out, input);
  }
  double s = 0;
  const TriMesh out = by_cgal(input, count, s);
  print_row("CGAL Garland-Heckbert", s, out, input);
  return 0;
} catch (const Error& e) {
  std::fprintf(stderr, "%s\n", e.line("bench_decimate").c_str());
  return static_cast<int>(e.code());
}
