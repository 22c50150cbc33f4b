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
#include <sys/resource.h>
#include <vtkCellArray.h>
#include <vtkDecimatePro.h>
#include <vtkFlyingEdges3D.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkQuadricDecimation.h>
#include <vtkShortArray.h>
#ifdef BENCH_MESHOPTIMIZER
#include <meshoptimizer.h>
#endif

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include "../tests/report_of.h"
#include "base/error.h"
#include "base/spawn.h"
#include "grid/nrrd.h"
#include "meshing/contour.h"
#include "meshing/decimate.h"
#include "meshing/marching_cubes.h"
#include "meshing/validity.h"
#include "metrics/deviation.h"
#include "scratch_folder.h"

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

surface::TriMesh by_cgal(const surface::TriMesh& mesh, std::size_t triangles, double& seconds) {
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
  surface::TriMesh out;
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

vtkNew<vtkPolyData> to_vtk(const surface::TriMesh& mesh) {
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (const Vec3 p : mesh.points_mm) points->InsertNextPoint(p.x, p.y, p.z);
  vtkNew<vtkCellArray> cells;
  for (const auto& t : mesh.triangles) {
    const vtkIdType ids[3] = {t[0], t[1], t[2]};
    cells->InsertNextCell(3, ids);
  }
  vtkNew<vtkPolyData> data;
  data->SetPoints(points);
  data->SetPolys(cells);
  return data;
}

template <class Filter>
surface::TriMesh by_vtk(const surface::TriMesh& mesh, std::size_t triangles, double& seconds) {
  const vtkNew<vtkPolyData> data = to_vtk(mesh);
  vtkNew<Filter> filter;
  filter->SetInputData(data);
  filter->SetTargetReduction(1 - double(triangles) / double(mesh.triangles.size()));
  if constexpr (std::is_same_v<Filter, vtkDecimatePro>) filter->PreserveTopologyOn();
  seconds = timed([&] { filter->Update(); });
  surface::TriMesh out;
  out.origin_mm = mesh.origin_mm;
  vtkPolyData* result = filter->GetOutput();
  for (vtkIdType i = 0; i < result->GetNumberOfPoints(); ++i) {
    double p[3];
    result->GetPoint(i, p);
    out.points_mm.push_back({p[0], p[1], p[2]});
  }
  vtkIdType n = 0;
  const vtkIdType* ids = nullptr;
  for (result->GetPolys()->InitTraversal(); result->GetPolys()->GetNextCell(n, ids);)
    out.triangles.push_back({std::uint32_t(ids[0]), std::uint32_t(ids[1]), std::uint32_t(ids[2])});
  surface::drop_unused_points(out);
  return out;
}

#ifdef BENCH_MESHOPTIMIZER
surface::TriMesh by_meshoptimizer(const surface::TriMesh& mesh, std::size_t triangles, double& seconds) {
  std::vector<float> points;
  for (const Vec3 p : mesh.points_mm) points.insert(points.end(), {float(p.x), float(p.y), float(p.z)});
  const auto* indices = mesh.triangles.front().data();
  std::vector<unsigned> left(3 * mesh.triangles.size());
  seconds = timed([&] {
    left.resize(meshopt_simplify(left.data(), indices, left.size(), points.data(), mesh.points_mm.size(), 12,
                                 3 * triangles, 1.0f, 0, nullptr));
  });
  surface::TriMesh out;
  out.origin_mm = mesh.origin_mm;
  out.points_mm = mesh.points_mm;
  for (std::size_t n = 0; n < left.size(); n += 3) out.triangles.push_back({left[n], left[n + 1], left[n + 2]});
  surface::drop_unused_points(out);
  return out;
}
#endif

double peak_mib() {
  rusage r{};
  getrusage(RUSAGE_SELF, &r);
  return static_cast<double>(r.ru_maxrss) / 1024;
}

void print_row(const char* name, double seconds, double mib, const surface::TriMesh& mesh,
               const surface::TriMesh& input) {
  const meshing::Validity v = meshing::check_validity(mesh);
  const metrics::Deviation d = metrics::measure_deviation(mesh, input);
  const metrics::DeviationStats &to = d.mesh_to_reference, &from = d.reference_to_mesh;
  std::printf("| %s | %.2f | %.0f | %zu | %zu | %zu | %zu | %.3f / %.3f / %.4f | %.3f / %.3f / %.4f | %.3f / %.4f |\n",
              name, seconds, mib, mesh.triangles.size(), v.topology.boundary_edges,
              v.topology.nonmanifold_edges + v.topology.nonmanifold_points + v.topology.duplicate_triangles,
              v.self_intersections, to.max_mm, to.p99_mm, to.rms_mm, from.max_mm, from.p99_mm, from.rms_mm,
              d.both.p99_mm, d.both.rms_mm);
}

void contours(const grid::Grid<std::int16_t>& grid, double isovalue) {
  surface::TriMesh ours;
  const double seconds = timed(
      [&] { ours = meshing::marching_cubes(grid, isovalue, meshing::find_inside(grid, isovalue), 0.002, Progress()); });
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

template <class Array>
void exchange(std::FILE* file, Array& v, bool write) {
  using T = typename Array::value_type;
  std::size_t n = v.size();
  if (write) {
    std::fwrite(&n, sizeof n, 1, file);
    std::fwrite(v.data(), sizeof(T), n, file);
  } else if (std::fread(&n, sizeof n, 1, file) == 1) {
    v.resize(n);
    if (std::fread(v.data(), sizeof(T), n, file) != n) v.clear();
  }
}
void exchange(const char* name, surface::TriMesh& mesh, bool write) {
  std::FILE* file = std::fopen(name, write ? "wb" : "rb");
  if (!file) throw Error(ExitCode::cannot_create, name, "", std::strerror(errno));
  exchange(file, mesh.points_mm, write);
  exchange(file, mesh.triangles, write);
  if (std::fclose(file) != 0) throw Error(ExitCode::io, name, "", std::strerror(errno));
}

void contour_to(const char* surface, const char* volume_file, double isovalue) {
  const grid::HuVolume volume = grid::read_hu_nrrd(volume_file);
  meshing::ContourParams c;
  c.isovalue_hu = isovalue;
  c.min_component_mm3 = 1e9;
  if (const auto* grid = std::get_if<grid::Grid<std::int16_t>>(&volume)) contours(*grid, c.isovalue_hu);
  Report report;
  surface::TriMesh mesh;
  const double seconds = timed([&] { mesh = value_of(report, meshing::contour(volume, c)); });
  std::printf("%-28s %7.2f s %8zu\n", "contour, checked", seconds, mesh.triangles.size());
  const double checking = timed([&] { meshing::check_validity(mesh); });
  std::printf("%-28s %7.2f s\n\n", "check_validity", checking);
  exchange(surface, mesh, true);
}

struct Row {
  const char* name;
  std::function<surface::TriMesh(const surface::TriMesh& input, double& seconds)> decimator;
};

std::vector<Row> rows_of(std::size_t count, double bound_mm) {
  const auto ours = [count](double most_mm) {
    return [=](const surface::TriMesh& input, double& s) {
      meshing::DecimateParams d;
      d.target_triangles_count = static_cast<std::int64_t>(count);
      d.max_deviation_mm = most_mm;
      meshing::require_valid(input);  // as after contour, which has checked it: decimate does not check again
      surface::TriMesh out;
      s = timed([&] {
        Report r;
        out = value_of(r, meshing::decimate(input, d));
      });
      return out;
    };
  };
  return {
      {"ours, count", ours(0)},
      {"ours, count and bound", ours(bound_mm)},
      {"vtkDecimatePro, topology preserved",
       [=](const surface::TriMesh& input, double& s) { return by_vtk<vtkDecimatePro>(input, count, s); }},
      {"vtkQuadricDecimation",
       [=](const surface::TriMesh& input, double& s) { return by_vtk<vtkQuadricDecimation>(input, count, s); }},
#ifdef BENCH_MESHOPTIMIZER
      {"meshoptimizer", [=](const surface::TriMesh& input, double& s) { return by_meshoptimizer(input, count, s); }},
#endif
      {"CGAL edge_collapse, Garland-Heckbert",
       [=](const surface::TriMesh& input, double& s) { return by_cgal(input, count, s); }}};
}

/// Contouring and each row run in a process of their own, so that a row's peak of memory is its own (with the input's,
/// which all have) and a library that dies loses its row only.
bool in_own_process(std::vector<std::string> words) {
  std::fflush(stdout);
  SpawnRequest request;
  request.argv = std::move(words);
  request.program = own_program().string();
  request.shares_stdout = request.shares_stderr = true;
  return wait_for(spawn(request), until_it_ends_s).code == 0;
}

}  // namespace

int main(int argc, char** argv) try {
  const std::string mode = argc > 1 ? argv[1] : "";
  const auto number = [&](int n, double otherwise) { return argc > n ? std::atof(argv[n]) : otherwise; };
  if (mode == "--contour") return contour_to(argv[2], argv[3], number(4, 0)), 0;
  if (argc < 2) return std::fprintf(stderr, "bench_decimate VOLUME.nrrd [isovalue_hu [triangles [bound_mm]]]\n"), 64;
  const bool one = mode == "--row";  // --row N SURFACE, then as without it
  const auto count = static_cast<std::size_t>(number(one ? 5 : 3, 80000));
  const std::vector<Row> rows = rows_of(count, number(one ? 6 : 4, 0.3));
  if (one) {
    const Row& row = rows.at(static_cast<std::size_t>(std::atoi(argv[2])));
    surface::TriMesh input;
    exchange(argv[3], input, false);
    double seconds = 0;
    const surface::TriMesh out = row.decimator(input, seconds);
    print_row(row.name, seconds, peak_mib(), out, input);
    return 0;
  }
  const std::string isovalue = argc > 2 ? argv[2] : "226.5", bound = argc > 4 ? argv[4] : "0.3";
  const ScratchFolder folder;
  const std::string surface = folder.path() / "surface";
  if (!in_own_process({"bench_decimate", "--contour", surface, argv[1], isovalue})) return 1;
  surface::TriMesh input;
  exchange(surface.c_str(), input, false);
  std::printf(
      "| %zu triangles to %zu | s | peak MiB | triangles | open edges | non-manifold | intersecting pairs | result to "
      "input: max / p99 / RMS mm | input to result | both: p99 / RMS |\n|---|---|---|---|---|---|---|---|---|---|\n",
      input.triangles.size(), count);
  for (std::size_t n = 0; n < rows.size(); ++n)
    if (!in_own_process(
            {"bench_decimate", "--row", std::to_string(n), surface, isovalue, std::to_string(count), bound}))
      std::printf("| %s | died |\n", rows[n].name);
  return 0;
} catch (const Error& e) {
  std::fprintf(stderr, "%s\n", e.line("bench_decimate").c_str());
  return static_cast<int>(e.code());
}
