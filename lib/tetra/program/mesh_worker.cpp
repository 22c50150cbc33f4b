// SPDX-License-Identifier: GPL-3.0-or-later
// CGAL's Mesh_3: Delaunay refinement of a domain that is known by its labels [Jamin2015], and the removal of slivers.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Labeled_mesh_domain_3.h>
#include <CGAL/Mesh_complex_3_in_triangulation_3.h>
#include <CGAL/Mesh_criteria_3.h>
#include <CGAL/Mesh_triangulation_3.h>
#include <CGAL/Random.h>
#include <CGAL/refine_mesh_3.h>

#include <functional>
#include <map>

#include "base/child.h"
#include "base/child_message.h"
#include "surface/bounds.h"
#include "tetra/program/filled.h"
#include "tetra/program/regions.h"
#include "tetra/program/seeds.h"
#include "tetra/tetra_message.h"

namespace trephine::tetra {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Domain = CGAL::Labeled_mesh_domain_3<Kernel>;
using Triangulation = CGAL::Mesh_triangulation_3<Domain>::type;
using Complex = CGAL::Mesh_complex_3_in_triangulation_3<Triangulation>;
using Criteria = CGAL::Mesh_criteria_3<Triangulation>;

constexpr double least_angle_deg = 25, longest_ratio = 2;  // of a border's triangle; of outer radius to shortest edge
constexpr double sliver_deg = 12;      // angles between faces are brought above it where that can be done
constexpr double precision_mm = 1e-3;  // of a point on a border

Vec3 place_of(const Complex::Vertex_handle& v) { return {v->point().x(), v->point().y(), v->point().z()}; }

Filled filled_of(const Complex& complex) {
  Filled out;
  std::map<Complex::Vertex_handle, std::uint32_t> number;
  const auto number_of = [&](const Complex::Vertex_handle& v) {
    const auto [at, is_new] = number.emplace(v, std::uint32_t(out.points.size()));
    if (is_new) out.points.push_back(place_of(v));
    return at->second;
  };
  for (auto c = complex.cells_in_complex_begin(); c != complex.cells_in_complex_end(); ++c) {
    std::array<std::uint32_t, 4> t{};
    for (int n = 0; n < 4; ++n) t[std::size_t(n)] = number_of(c->vertex(n));
    out.tetrahedra.push_back(t);
    out.region_of.push_back(std::uint8_t(complex.subdomain_index(c)));
  }
  return out;
}

Filled fill(const std::vector<surface::TriMesh>& surfaces, double size_mm, double border_mm) {
  CGAL::get_default_random() = CGAL::Random(1);  // else the time is the seed
  CGAL::Random random(1);
  surface::Bounds all;
  for (const surface::TriMesh& s : surfaces) surface::include(all, surface::bounds_of(s));
  const Vec3 middle = (all.min_mm + all.max_mm) / 2, half = (all.max_mm - all.min_mm) * 0.55;
  const Regions regions(surfaces);
  const std::function<int(const Kernel::Point_3&)> label = [&](const Kernel::Point_3& p) {
    return regions.at({p.x(), p.y(), p.z()});
  };
  const CGAL::Bbox_3 box(middle.x - half.x, middle.y - half.y, middle.z - half.z, middle.x + half.x, middle.y + half.y,
                         middle.z + half.z);
  namespace param = CGAL::parameters;
  const Domain domain(label, box, param::relative_error_bound = precision_mm / (2 * norm(half)),
                      param::p_rng = &random);
  const Criteria criteria(param::facet_angle = least_angle_deg, param::facet_size = size_mm,
                          param::facet_distance = border_mm, param::cell_radius_edge_ratio = longest_ratio,
                          param::cell_size = size_mm);
  Complex complex;
  for (const Seed& s : seeds_of(surfaces, regions, size_mm)) {
    const auto v = complex.triangulation().insert(
        Triangulation::Weighted_point(Kernel::Point_3(s.world_mm.x, s.world_mm.y, s.world_mm.z)));
    complex.set_dimension(v, 2);
    complex.set_index(v, domain.index_from_surface_patch_index(Domain::Surface_patch_index(
                             std::min(s.between[0], s.between[1]), std::max(s.between[0], s.between[1]))));
  }
  // Without limits of time (0), which are else the time that the refinement took: the result would depend on the
  // machine.
  CGAL::refine_mesh_3(complex, domain, criteria, param::no_lloyd(), param::no_odt(),
                      param::perturb(param::time_limit = 0, param::sliver_bound = sliver_deg),
                      param::exude(param::time_limit = 0, param::sliver_bound = sliver_deg));
  return in_order(filled_of(complex));
}

const ChildWorker worker(tetra_worker, [](ChildRequest& request) {
  MessageReader in(tetra_worker, request.request());
  if (in.text() != tetra_build)
    throw Error(ExitCode::internal, "trephine-tetra", "", "is not of the same version as the program that called it");
  const auto size_mm = in.value<double>(), border_mm = in.value<double>();
  std::vector<surface::TriMesh> surfaces(in.number());
  for (surface::TriMesh& s : surfaces) {
    const auto points = in.array<Vec3>();
    const auto triangles = in.array<std::array<std::uint32_t, 3>>();
    for (const Vec3 p : points) s.points_mm.push_back(p);
    for (const auto& t : triangles) s.triangles.push_back(t);
  }
  Filled filled = fill(surfaces, size_mm, border_mm);
  const std::uint64_t joined = join_lone_cells(filled);
  add_borders(filled);
  MessageWriter out;
  out.array(filled.points);
  out.array(filled.tetrahedra);
  out.array(filled.region_of);
  out.array(filled.borders);
  out.array(filled.between);
  out.number(joined);
  request.write(out.bytes());
});

}  // namespace
}  // namespace trephine::tetra
