// SPDX-License-Identifier: GPL-3.0-or-later
#include "touch/felt_mesh.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace trephine::touch {
namespace {

surface::TriMesh checked(surface::TriMesh mesh) {
  surface::check_mesh(mesh);
  if (mesh.triangles.empty()) throw Error(ExitCode::bad_input, "", "mesh", "has no triangles");
  return mesh;
}

}  // namespace

FeltMesh::FeltMesh(surface::TriMesh mesh) : mesh_(checked(std::move(mesh))), tree_(mesh_) {
  normals_.reserve(mesh_.triangles.size());
  for (std::size_t t = 0; t < mesh_.triangles.size(); ++t)
    normals_.push_back(normalized(surface::triangle_normal(mesh_, t)));
  const double side = std::sqrt(2 * surface::area_mm2(mesh_) / double(mesh_.triangles.size()));
  piece_mm_ = std::max(2 * side, 0.1);
}

bool FeltMesh::is_over(std::uint32_t triangle, Vec3 p) const {
  const Vec3 a = corner(triangle, 0), b = corner(triangle, 1), c = corner(triangle, 2), n = normals_[triangle];
  return dot(cross(b - a, p - a), n) >= 0 && dot(cross(c - b, p - b), n) >= 0 && dot(cross(a - c, p - c), n) >= 0;
}

FeltMesh::Crossing FeltMesh::first_crossing(Vec3 from, Vec3 to, const std::uint32_t* but, int buts) const {
  Crossing best;
  const Vec3 way = to - from;
  look_along(from, to, 0, best.along, [&](std::uint32_t t) {
    const double begin = above(t, from), last = above(t, to);
    if (!(begin >= 0 && last < 0) || std::find(but, but + buts, t) != but + buts) return;
    const double along = begin / (begin - last);
    if (along < best.along && is_over(t, from + way * along)) best = {t, along};
  });
  return best;
}

std::optional<FeltMesh::Near> FeltMesh::nearest(Vec3 p, double reach_mm) const {
  Near near;
  const double limit = reach_mm * reach_mm;
  if (!(tree_.squared_distance(p, limit, &near.triangle) < limit)) return {};
  near.point =
      surface::closest_on_triangle(p, corner(near.triangle, 0), corner(near.triangle, 1), corner(near.triangle, 2));
  return near;
}

}  // namespace trephine::touch
