// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/validity.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "meshing/exact.h"

namespace trephine {

std::string Validity::text() const {
  std::string faults;
  const auto add = [&](std::size_t n, const char* what) {
    if (n > 0) faults += (faults.empty() ? "" : ", ") + std::to_string(n) + " " + what;
  };
  if (topology.triangles == 0) return "no triangles";
  add(topology.boundary_edges, "open edges");
  add(topology.nonmanifold_edges, "edges of three or more triangles");
  add(topology.nonmanifold_points, "points where the surface meets itself");
  add(topology.misoriented_edges, "edges between triangles that look to opposite sides");
  add(topology.duplicate_triangles, "duplicate triangles");
  add(degenerate, "degenerate triangles");
  add(self_intersections, "pairs of intersecting triangles");
  if (faults.empty() && !(volume_mm3 > 0)) return "looks inwards";
  return faults.empty() ? "closed, 2-manifold, no self-intersections" : faults;
}

std::vector<std::uint32_t> degenerate_triangles(const TriMesh& mesh) {
  std::vector<std::uint32_t> found;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& v = mesh.triangles[t];
    if (on_a_line(mesh.points_mm[v[0]], mesh.points_mm[v[1]], mesh.points_mm[v[2]])) found.push_back(t);
  }
  return found;
}

Validity check_validity(const TriMesh& mesh, const Progress& progress) {
  check_mesh(mesh);
  Validity v;
  v.topology = topology_of(mesh);
  progress.report(0.3);
  v.volume_mm3 = volume_mm3(mesh);
  v.float32 = std::all_of(mesh.points_mm.begin(), mesh.points_mm.end(), [](Vec3 p) {
    return p.x == static_cast<float>(p.x) && p.y == static_cast<float>(p.y) && p.z == static_cast<float>(p.z);
  });
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.points_mm[t[0]], b = mesh.points_mm[t[1]], c = mesh.points_mm[t[2]];
    const double longest2 = std::max({dot(b - a, b - a), dot(c - b, c - b), dot(a - c, a - c)});
    const double height = norm(cross(b - a, c - a)) / std::sqrt(longest2);
    if (height > 1e-3 * std::sqrt(longest2)) continue;
    if (on_a_line(a, b, c))
      ++v.degenerate;
    else
      ++v.slivers;
  }
  v.self_intersections = self_intersections(mesh, progress.part(0.4, 1)).size();
  progress.report(1);
  return v;
}

double float32_step_mm(const TriMesh& mesh) {
  double reach = 0;
  for (const Vec3 p : mesh.points_mm) reach = std::max({reach, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  if (!(reach > 0)) return std::ldexp(1.0, -14);
  int exponent = 0;
  std::frexp(reach, &exponent);  // reach < 2^exponent
  return std::ldexp(1.0, exponent >= 5 && exponent <= 9 ? -14 : exponent - 23);
}

void centre_origin(TriMesh& mesh) {
  if (mesh.points_mm.empty()) return;
  Vec3 low = mesh.points_mm.front(), high = low;
  for (const Vec3 p : mesh.points_mm)
    for (int a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], p[a]);
      high[a] = std::max(high[a], p[a]);
    }
  const Vec3 centre = (low + high) / 2;
  const double half = norm(high - low) / 2;
  if (norm(centre) <= half || !(half > 0)) return;
  // Whole mm, or a power of two small enough not to matter to a small mesh.
  const double unit = std::min(1.0, std::exp2(std::floor(std::log2(half)) - 4));
  Vec3 shift;
  for (int a = 0; a < 3; ++a)
    shift[a] = std::nearbyint((mesh.origin_mm[a] + centre[a]) / unit) * unit - mesh.origin_mm[a];
  for (Vec3& p : mesh.points_mm) p = p - shift;
  mesh.origin_mm += shift;
}

void snap_to_float32(TriMesh& mesh) {
  centre_origin(mesh);
  const double step = float32_step_mm(mesh);
  parallel_for(0, static_cast<std::int64_t>(mesh.points_mm.size()), 65536, [&](std::int64_t from, std::int64_t to) {
    for (std::int64_t i = from; i < to; ++i) {
      Vec3& p = mesh.points_mm[i];
      p = {std::nearbyint(p.x / step) * step, std::nearbyint(p.y / step) * step, std::nearbyint(p.z / step) * step};
    }
  });
}

void require_valid(const TriMesh& mesh, const Progress& progress) {
  const Validity v = check_validity(mesh, progress);
  if (!v.valid()) throw Error(ExitCode::quality, "", "", v.text());
}

}  // namespace trephine
