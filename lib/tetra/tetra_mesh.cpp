// SPDX-License-Identifier: GPL-3.0-or-later
#include "tetra/tetra_mesh.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/child.h"
#include "base/child_message.h"
#include "base/error.h"
#include "base/own_files.h"
#include "base/refusal.h"
#include "base/text.h"
#include "metrics/deviation.h"
#include "surface/bounds.h"
#include "surface/inside.h"
#include "surface/inside_query.h"
#include "surface/triangle_tree.h"
#include "tetra/tetra_message.h"

namespace trephine::tetra {

const char* const tetra_build = TREPHINE_VERSION " 1";  // the number changes with the messages

namespace {

constexpr const char* program_name = "trephine-tetra";
constexpr double counted_cells = 4e6;        // of the lattice on which volumes are counted
constexpr double most_volume_ratio = 0.1;    // that a region's volume may be off
constexpr int samples = 50000;               // of each surface, for its deviation
constexpr double cubes_a_tetrahedron = 0.2;  // the volume of one, in cubes of size_mm; measured
constexpr double most_tetrahedra = 2e7;
const ChildLimits limits{std::uint64_t{16} << 30, 7200, 14400};

const Remedy smaller{"a smaller `size_mm` makes smaller tetrahedra"};

std::string short_ml(double ml) { return to_text(std::round(1000 * ml) / 1000); }

// The numbers of the surfaces, that with the least volume first: it has a place that several hold.
std::vector<std::size_t> smallest_first(const std::vector<NamedSurface>& surfaces) {
  std::vector<double> volume;
  for (const NamedSurface& s : surfaces) {
    surface::check_mesh(*s.mesh);
    const surface::Topology topology = surface::topology_of(*s.mesh);
    volume.push_back(std::abs(surface::volume_mm3(*s.mesh)));
    if (!topology.closed() || !(volume.back() > 0))
      throw Error(ExitCode::bad_input, "", s.name, "its surface is not closed, so that nothing is within it");
  }
  std::vector<std::size_t> order(surfaces.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return volume[a] < volume[b]; });
  return order;
}

TetraMesh run_mesher(const std::vector<NamedSurface>& surfaces, const std::vector<std::size_t>& order,
                     const TetraParams& params, std::size_t& joined, const Progress& progress) {
  const std::filesystem::path program = own_file({program_name});
  if (program.empty())
    throw Error(ExitCode::internal, program_name, "",
                "is missing: it must lie in the folder of the other programs; it is built with -DTREPHINE_TETRA=ON");
  MessageWriter request;
  request.text(tetra_build);
  request.value(params.size_mm);
  request.value(params.border_mm);
  request.number(order.size());
  for (const std::size_t s : order) {
    std::vector<Vec3> points;
    for (std::size_t n = 0; n < surfaces[s].mesh->points_mm.size(); ++n)
      points.push_back(surfaces[s].mesh->world_mm(n));
    request.array(points);
    request.array(surfaces[s].mesh->triangles);
  }
  const ChildResult result = run_child(tetra_worker, request.bytes(), limits, progress, {program});
  MessageReader in(tetra_worker, result.bytes());
  TetraMesh mesh;
  for (const NamedSurface& s : surfaces) mesh.regions.push_back(s.name);
  mesh.points_mm = in.array<Vec3>();
  mesh.tetrahedra = in.array<std::array<std::uint32_t, 4>>();
  mesh.region_of = in.array<std::uint8_t>();
  mesh.borders = in.array<std::array<std::uint32_t, 3>>();
  mesh.between = in.array<std::array<std::uint8_t, 2>>();
  joined = in.number();
  bool sound = mesh.region_of.size() == mesh.tetrahedra.size() && mesh.between.size() == mesh.borders.size();
  for (const auto& t : mesh.tetrahedra)
    for (const std::uint32_t c : t) sound = sound && c < mesh.points_mm.size();
  for (const auto& t : mesh.borders)
    for (const std::uint32_t c : t) sound = sound && c < mesh.points_mm.size();
  // From the order in which they were sent to that of the case.
  const auto renumber = [&](std::uint8_t& region) {
    sound = sound && region <= order.size();
    if (sound && region > 0) region = std::uint8_t(order[region - 1u] + 1);
  };
  for (std::uint8_t& r : mesh.region_of) {
    sound = sound && r > 0;
    renumber(r);
  }
  for (auto& b : mesh.between) {
    sound = sound && b[0] > 0;
    for (std::uint8_t& r : b) renumber(r);
  }
  if (!sound) throw Error(ExitCode::internal, program_name, "", "returned a damaged mesh");
  return mesh;
}

// ml within each surface and within none before it in the order, on a lattice over all.
std::vector<double> counted_ml(const std::vector<NamedSurface>& surfaces, const std::vector<std::size_t>& order,
                               const Progress& progress) {
  surface::Bounds all;
  for (const NamedSurface& s : surfaces) surface::include(all, surface::bounds_of(*s.mesh));
  const Vec3 side = all.max_mm - all.min_mm;
  const double cell = std::cbrt(side.x * side.y * side.z / counted_cells);
  grid::Lattice lattice;
  for (int a = 0; a < 3; ++a) lattice.size[std::size_t(a)] = int(side[a] / cell) + 2;
  lattice.spacing_mm = {cell, cell, cell};
  lattice.origin_mm = all.min_mm - Vec3{1, 1, 1} * (0.25 * cell);
  std::vector<std::uint8_t> taken(lattice.count(), 0);
  std::vector<double> ml(surfaces.size(), 0);
  for (const std::size_t s : order) {
    const grid::Mask inside = surface::voxelize_inside(*surfaces[s].mesh, lattice, progress);
    std::size_t count = 0;
    for (std::size_t n = 0; n < taken.size(); ++n)
      if (inside.voxels[n] != 0 && taken[n] == 0) {
        taken[n] = 1;
        ++count;
      }
    ml[s] = double(count) * lattice.voxel_volume_mm3() / 1000;
  }
  return ml;
}

// In both directions: from the borders on the surface to it, and from where it is not within a smaller one to the
// nearest border of all, for surfaces that touch share one border.
void add_deviation(const TetraMesh& mesh, const surface::TriMesh& all_borders,
                   const std::vector<NamedSurface>& surfaces, const std::vector<std::size_t>& order, std::size_t s,
                   RegionResult& region) {
  std::vector<surface::InsideQuery> smaller_ones;
  for (const std::size_t other : order) {
    if (other == s) break;
    smaller_ones.emplace_back(*surfaces[other].mesh);
  }
  const surface::TriMesh& own = *surfaces[s].mesh;
  const surface::TriangleTree to_own(own), to_borders(all_borders);
  std::vector<double> mm;
  const auto add = [&](const surface::TriangleTree& tree, Vec3 origin_mm, Vec3 p) {
    mm.push_back(std::sqrt(tree.squared_distance(p - origin_mm, 1e12)));
  };
  const surface::TriMesh on_it = borders_of(mesh, std::uint8_t(s + 1));
  for (const Vec3 p : on_it.points_mm) add(to_own, own.origin_mm, p);
  if (!on_it.triangles.empty())
    for (const Vec3 p : metrics::points_on_surface(on_it, samples)) add(to_own, own.origin_mm, p);
  for (const Vec3 p : metrics::points_on_surface(own, samples))
    if (std::none_of(smaller_ones.begin(), smaller_ones.end(), [&](const auto& q) { return q.inside(p); }))
      add(to_borders, all_borders.origin_mm, p);
  if (mm.empty()) return;
  std::sort(mm.begin(), mm.end());
  double squares = 0;
  for (const double d : mm) squares += d * d;
  region.deviation_max_mm = mm.back();
  region.deviation_p99_mm = mm[std::size_t(std::ceil(0.99 * double(mm.size()))) - 1];
  region.deviation_rms_mm = std::sqrt(squares / double(mm.size()));
}

}  // namespace

Outcome<TetraMesh, TetraResult> fill_with_tetrahedra(const std::vector<NamedSurface>& surfaces,
                                                     const TetraParams& params, const Progress& progress) {
  if (surfaces.empty()) throw Error(ExitCode::bad_input, "", "", "there is no surface to fill");
  if (surfaces.size() > 255) throw Error(ExitCode::bad_input, "", "", "more than 255 surfaces cannot be told apart");
  const std::vector<std::size_t> order = smallest_first(surfaces);
  const double about = std::abs(surface::volume_mm3(*surfaces[order.back()].mesh)) /
                       (cubes_a_tetrahedron * params.size_mm * params.size_mm * params.size_mm);
  if (about > most_tetrahedra)
    throw Error(ExitCode::usage, "", "--size-mm",
                to_text(params.size_mm) + ": that are some " + grouped_text(static_cast<long long>(about)) +
                    " tetrahedra, and at most " + grouped_text(static_cast<long long>(most_tetrahedra)) +
                    " are made; give a larger one");
  Outcome<TetraMesh, TetraResult> out;
  TetraResult& r = out.result;
  TetraMesh& mesh = out.value = run_mesher(surfaces, order, params, r.joined_count, progress.part(0, 0.8));
  r.points_count = mesh.points_mm.size();
  r.tetrahedra_count = mesh.tetrahedra.size();
  r.borders_count = mesh.borders.size();
  for (const NamedSurface& s : surfaces) r.regions.emplace_back(s.name, RegionResult());
  for (std::size_t n = 0; n < mesh.tetrahedra.size(); ++n) {
    RegionResult& region = r.regions[mesh.region_of[n] - 1u].second;
    ++region.tetrahedra_count;
    region.volume_ml += volume_mm3(mesh, n) / 1000;
  }
  for (const auto& b : mesh.between) ++r.regions[b[0] - 1u].second.borders_count;
  if (!mesh.tetrahedra.empty()) r.quality = quality_of(mesh);
  const surface::TriMesh all_borders = borders_of(mesh, 0);
  const std::vector<double> counted = counted_ml(surfaces, order, progress.part(0.8, 0.85));
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    RegionResult& region = r.regions[s].second;
    region.counted_volume_ml = counted[s];
    if (!(std::abs(region.volume_ml - counted[s]) <= most_volume_ratio * counted[s]))
      throw refusal(surfaces[s].name,
                    "its tetrahedra fill " + short_ml(region.volume_ml) + " ml of " + short_ml(counted[s]) + " ml",
                    smaller);
    add_deviation(mesh, all_borders, surfaces, order, s, region);
    progress.part(0.85, 1).report(double(s + 1) / double(surfaces.size()));
  }
  return out;
}

}  // namespace trephine::tetra
