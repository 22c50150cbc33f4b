// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/validity.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "base/error.h"
#include "base/parallel.h"
#include "base/params.h"
#include "base/refusal.h"
#include "meshing/exact.h"
#include "meshing/float32_raster.h"
#include "surface/bounds.h"

namespace trephine::meshing {

namespace {

std::string in_mm(Vec3 p) {
  const auto rounded = [](double v) { return to_text(ParameterValue(std::nearbyint(v * 1000) / 1000 + 0.0)); };
  return rounded(p.x) + ", " + rounded(p.y) + ", " + rounded(p.z) + " mm";
}

}  // namespace

std::string Validity::text() const {
  std::string faults;
  const auto add = [&](std::size_t n, const char* what, const std::vector<Vec3>& where) {
    if (n == 0) return;
    faults += (faults.empty() ? "" : ", ") + std::to_string(n) + " " + what;
    if (!where.empty()) faults += (n > 1 ? " (the first at " : " (at ") + in_mm(where.front()) + ")";
  };
  if (topology.triangles == 0) return "no triangles";
  add(topology.boundary_edges, "open edges", places.open_edges);
  add(topology.nonmanifold_edges, "edges of three or more triangles", places.nonmanifold_edges);
  add(topology.nonmanifold_points, "points where the surface meets itself", places.nonmanifold_points);
  add(topology.misoriented_edges, "edges between triangles that look to opposite sides", places.misoriented_edges);
  add(topology.duplicate_triangles, "duplicate triangles", places.duplicate_triangles);
  add(degenerate, "degenerate triangles", places.degenerate);
  add(self_intersections, "pairs of intersecting triangles", places.self_intersections);
  if (faults.empty() && !(volume_mm3 > 0)) return "looks inwards";
  return faults.empty() ? "closed, 2-manifold, no self-intersections" : faults;
}

std::vector<std::uint32_t> degenerate_triangles(const surface::TriMesh& mesh) {
  std::vector<std::uint32_t> found;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& v = mesh.triangles[t];
    if (on_a_line(mesh.points_mm[v[0]], mesh.points_mm[v[1]], mesh.points_mm[v[2]])) found.push_back(t);
  }
  return found;
}

namespace {

/// The checks that need no neighbours.
void look_at_each(const surface::TriMesh& mesh, Validity& v) {
  v.volume_mm3 = surface::volume_mm3(mesh);
  v.float32 = std::all_of(mesh.points_mm.begin(), mesh.points_mm.end(), [](Vec3 p) {
    return p.x == static_cast<float>(p.x) && p.y == static_cast<float>(p.y) && p.z == static_cast<float>(p.z);
  });
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& i = mesh.triangles[t];
    const Vec3 a = mesh.points_mm[i[0]], b = mesh.points_mm[i[1]], c = mesh.points_mm[i[2]];
    const double longest2 = std::max({dot(b - a, b - a), dot(c - b, c - b), dot(a - c, a - c)});
    const Vec3 n = cross(b - a, c - a);
    if (dot(n, n) > 1e-6 * longest2 * longest2) continue;
    const bool flat = on_a_line(a, b, c);
    (flat ? v.degenerate : v.slivers)++;
    auto& places = flat ? v.places.degenerate : v.places.slivers;
    if (places.size() < surface::FaultPlaces::limit) places.push_back(mesh.origin_mm + (a + b + c) / 3);
  }
}

}  // namespace

class ProofOfValidity {
 public:
  /// The number is a digest of what was proven, so that a later change which forgot no proof can be found.
  static void give(const surface::TriMesh& mesh) {
    const std::uint64_t number = digest_of(mesh);
    mesh.points_mm.proof_ = number;
    mesh.triangles.proof_ = number;
  }
  static bool holds(const surface::TriMesh& mesh) {
    return mesh.proven_valid() && digest_of(mesh) == mesh.points_mm.proof();
  }

 private:
  static std::uint64_t digest_of(const surface::TriMesh& mesh) {
    std::uint64_t h = mesh.points_mm.size();
    const auto add = [&h](std::uint64_t word) {
      h = (h ^ word) * 0x9fb21c651e98df25;
      h ^= h >> 32;
    };
    for (const Vec3& p : mesh.points_mm)
      for (const double v : {p.x, p.y, p.z}) {
        std::uint64_t word;
        std::memcpy(&word, &v, sizeof word);
        add(word);
      }
    for (const auto& t : mesh.triangles) {
      add(t[0] | std::uint64_t{t[1]} << 32);
      add(t[2]);
    }
    return h | 1;  // never 0, which means that there is no proof
  }
};

Validity check_validity(const surface::TriMesh& mesh, const Progress& progress, const grid::Lattice* cells) {
  surface::check_mesh(mesh);
  Validity v;
  const surface::Incidence incidence(mesh);
  std::vector<std::array<std::uint32_t, 2>> pairs;
  parallel_do({[&] {
                 const Progress part = progress.part(0.1, 0.9);
                 pairs = cells ? self_intersections(mesh, incidence, *cells, part)
                               : self_intersections(mesh, incidence, part);
               },
               [&] {
                 v.topology = surface::topology_of(mesh, incidence);
                 if (!v.topology.closed() || !v.topology.manifold())
                   surface::locate_topology_faults(mesh, incidence, v.places);
               },
               [&] { look_at_each(mesh, v); }});
  v.self_intersections = pairs.size();
  for (std::size_t i = 0; i < std::min(pairs.size(), surface::FaultPlaces::limit); ++i)
    v.places.self_intersections.push_back(surface::place_of_intersection_mm(mesh, pairs[i][0], pairs[i][1]));
  if (v.valid()) ProofOfValidity::give(mesh);
  progress.report(1);
  return v;
}

double float32_step_mm(const surface::TriMesh& mesh) {
  double reach = 0;
  for (const Vec3 p : mesh.points_mm) reach = std::max({reach, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  if (!(reach > 0)) return std::ldexp(1.0, -14);
  int exponent = 0;
  std::frexp(reach, &exponent);  // reach < 2^exponent
  return std::ldexp(1.0, exponent >= 5 && exponent <= 9 ? -14 : exponent - 23);
}

namespace {

/// How far to move a mesh whose origin lies outside its bounds: by whole mm, or by a power of two that is small enough
/// for a small mesh.
bool shift_of_origin(const surface::TriMesh& mesh, Vec3& shift) {
  if (mesh.points_mm.empty()) return false;
  surface::Bounds box;
  for (const Vec3 p : mesh.points_mm) surface::include(box, p);
  const Vec3 low = box.min_mm, high = box.max_mm;
  const Vec3 centre = (low + high) / 2;
  const double half = norm(high - low) / 2;
  if (norm(centre) <= half || !(half > 0)) return false;
  const double unit = std::min(1.0, std::exp2(std::floor(std::log2(half)) - 4));
  for (int a = 0; a < 3; ++a)
    shift[a] = std::nearbyint((mesh.origin_mm[a] + centre[a]) / unit) * unit - mesh.origin_mm[a];
  return true;
}

}  // namespace

void centre_origin(surface::TriMesh& mesh) {
  Vec3 shift;
  if (!shift_of_origin(mesh, shift) || shift == Vec3{}) return;
  for (Vec3& p : mesh.points_mm) p = p - shift;
  mesh.origin_mm += shift;
}

bool on_float32_raster(const surface::TriMesh& mesh) {
  Vec3 shift;
  if (shift_of_origin(mesh, shift) && !(shift == Vec3{})) return false;
  const double step = float32_step_mm(mesh);
  return std::all_of(mesh.points_mm.begin(), mesh.points_mm.end(), [step](Vec3 p) {
    return p.x == std::nearbyint(p.x / step) * step && p.y == std::nearbyint(p.y / step) * step &&
           p.z == std::nearbyint(p.z / step) * step;
  });
}

void snap_to_float32(surface::TriMesh& mesh) {
  if (on_float32_raster(mesh)) return;
  centre_origin(mesh);
  const double step = float32_step_mm(mesh);
  parallel_for(0, static_cast<std::int64_t>(mesh.points_mm.size()), 65536, [&](std::int64_t from, std::int64_t to) {
    for (std::int64_t i = from; i < to; ++i) {
      Vec3& p = mesh.points_mm[i];
      p = {std::nearbyint(p.x / step) * step, std::nearbyint(p.y / step) * step, std::nearbyint(p.z / step) * step};
    }
  });
}

void require_valid(const surface::TriMesh& mesh, const Progress& progress) {
  if (ProofOfValidity::holds(mesh)) return;
  if (mesh.proven_valid())
    throw Error(ExitCode::internal, "", "mesh", "was changed through a reference that is older than its proof");
  const Validity v = check_validity(mesh, progress);
  if (!v.valid()) throw refusal("", v.text(), remedies::other_triangles);
}

}  // namespace trephine::meshing
