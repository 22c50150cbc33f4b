// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/reference_distance.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "meshing/prove_within.h"

namespace trephine::meshing {
namespace {

constexpr double no_limit = 1e300;

surface::TriMesh about(const surface::TriMesh& mesh, Vec3 origin_mm) {
  surface::TriMesh out = mesh;
  out.normals.clear();
  if (mesh.origin_mm == origin_mm) return out;
  for (Vec3& p : out.points_mm) p = p + (mesh.origin_mm - origin_mm);
  out.origin_mm = origin_mm;
  return out;
}

/// Each point's distance to the other surface, and where there.
std::vector<NearbyPlace> places_of(const surface::TriMesh& mesh, const surface::TriangleTree& to) {
  std::vector<NearbyPlace> places(mesh.points_mm.size());
  parallel_for(0, static_cast<std::int64_t>(places.size()), 2048, [&](std::int64_t from, std::int64_t end) {
    for (std::int64_t i = from; i < end; ++i) {
      NearbyPlace& p = places[static_cast<std::size_t>(i)];
      p.at = mesh.points_mm[static_cast<std::size_t>(i)];
      p.distance = std::sqrt(to.squared_distance(p.at, no_limit, &p.triangle));
    }
  });
  return places;
}

/// For each triangle of `from` whether it is not proven to lie within the bound of `to`.
std::vector<char> unproven(const surface::TriMesh& from, const std::vector<NearbyPlace>& places,
                           const surface::TriMesh& to, const surface::TriangleTree& tree, double bound_mm,
                           const Progress& progress) {
  std::vector<char> bad(from.triangles.size(), 0);
  parallel_for(0, static_cast<std::int64_t>(bad.size()), 1024, [&](std::int64_t begin, std::int64_t end) {
    progress.check();
    std::vector<std::array<NearbyPlace, 3>> stack;
    const auto look = [&](NearbyPlace& p) {
      std::uint32_t nearest = p.triangle;
      const double d = std::sqrt(tree.squared_distance(p.at, p.distance * p.distance, &nearest));
      if (d < p.distance) p.distance = d, p.triangle = nearest;
    };
    for (std::int64_t t = begin; t < end; ++t) {
      const auto& v = from.triangles[static_cast<std::size_t>(t)];
      bad[static_cast<std::size_t>(t)] =
          !proven_within({places[v[0]], places[v[1]], places[v[2]]}, bound_mm, to, look, stack);
    }
  });
  return bad;
}

double largest(const std::vector<NearbyPlace>& places) {
  double most = 0;
  for (const NearbyPlace& p : places) most = std::max(most, p.distance);
  return most;
}

}  // namespace

DistanceToReference::DistanceToReference(const surface::TriMesh& reference, Vec3 origin_mm)
    : reference_(about(reference, origin_mm)), tree_(reference_) {}

std::vector<std::uint32_t> DistanceToReference::beyond(const surface::TriMesh& mesh, double bound_mm,
                                                       const Progress& progress) const {
  const surface::TriangleTree own(mesh);
  const auto from_mesh = places_of(mesh, tree_), from_reference = places_of(reference_, own);
  std::vector<char> bad = unproven(mesh, from_mesh, reference_, tree_, bound_mm, progress);
  const std::vector<char> missed = unproven(reference_, from_reference, mesh, own, bound_mm, progress);
  // What of the reference is too far is put down to the triangles that are nearest to its corners.
  for (std::size_t t = 0; t < missed.size(); ++t)
    if (missed[t])
      for (const std::uint32_t v : reference_.triangles[t]) bad[from_reference[v].triangle] = 1;
  std::vector<std::uint32_t> found;
  for (std::uint32_t t = 0; t < bad.size(); ++t)
    if (bad[t]) found.push_back(t);
  return found;
}

double DistanceToReference::largest_mm(const surface::TriMesh& mesh) const {
  const surface::TriangleTree own(mesh);
  return std::max(largest(places_of(mesh, tree_)), largest(places_of(reference_, own)));
}

}  // namespace trephine::meshing
