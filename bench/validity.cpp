// SPDX-License-Identifier: GPL-3.0-or-later
// Our validity check beside CGAL's self_intersections in one run: bench_validity SURFACE.vtp [repetitions]. Wall clock
// and CPU of the best repetition. CGAL's does less: it finds the pairs only, of a mesh that is already in its
// structure.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <iterator>

#include "base/error.h"
#include "meshing/validity.h"
#include "meshio/vtp.h"

using namespace trephine;

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
namespace Pmp = CGAL::Polygon_mesh_processing;

double wall_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }
double cpu_s() {
  rusage u{};
  getrusage(RUSAGE_SELF, &u);
  return double(u.ru_utime.tv_sec + u.ru_stime.tv_sec) + 1e-6 * double(u.ru_utime.tv_usec + u.ru_stime.tv_usec);
}

template <class F>
void timed(const char* name, int repetitions, F&& f) {
  double wall = 1e9, cpu = 1e9;
  for (int i = 0; i < repetitions; ++i) {
    const double w = wall_s(), c = cpu_s();
    f();
    wall = std::min(wall, wall_s() - w);
    cpu = std::min(cpu, cpu_s() - c);
  }
  std::printf("%-36s %7.2f s wall %7.2f s CPU", name, wall, cpu);
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 2) return std::fprintf(stderr, "bench_validity SURFACE.vtp [repetitions]\n"), 64;
  const surface::TriMesh mesh = meshio::read_vtp(argv[1]);
  const int repetitions = argc > 2 ? std::max(1, std::atoi(argv[2])) : 3;
  std::printf("%zu triangles\n", mesh.triangles.size());
  meshing::Validity v;
  timed("check_validity, all of it", repetitions, [&] { v = meshing::check_validity(mesh); });
  std::printf("  %s\n", v.text().c_str());
  std::size_t pairs = 0;
  timed("  of it topology_of", repetitions, [&] { surface::topology_of(mesh); });
  std::printf("\n");
  timed("  of it self_intersections", repetitions, [&] { pairs = meshing::self_intersections(mesh).size(); });
  std::printf("  %zu pairs\n", pairs);

  Mesh theirs;
  for (const Vec3 p : mesh.points_mm) theirs.add_vertex({p.x, p.y, p.z});
  for (const auto& t : mesh.triangles)
    theirs.add_face(Mesh::Vertex_index(t[0]), Mesh::Vertex_index(t[1]), Mesh::Vertex_index(t[2]));
  using Pair = std::pair<Mesh::Face_index, Mesh::Face_index>;
  std::vector<Pair> found;
  timed("CGAL self_intersections", repetitions, [&] {
    found.clear();
    Pmp::self_intersections<CGAL::Sequential_tag>(theirs, std::back_inserter(found));
  });
  std::printf("  %zu pairs\n", found.size());
  return 0;
} catch (const Error& e) {
  std::fprintf(stderr, "%s\n", e.line("bench_validity").c_str());
  return static_cast<int>(e.code());
}
