// SPDX-License-Identifier: GPL-3.0-or-later
#include "boolean/cut_faces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace trephine::boolean::detail {
namespace {

constexpr double flat_mm = 0.02, min_area_mm2 = 60, normal_bin = 2e-3, offset_bin_mm = 0.05;
constexpr std::size_t min_triangles = 8, max_candidates = 32;

struct Facet {
  std::array<std::int32_t, 4> bin;  ///< of normal and offset
  std::uint32_t triangle;
};

struct Candidate {
  Vec3 normal;        ///< the triangles' area normals, summed
  double offset = 0;  ///< of the same, about the mesh's origin
  double area = 0;
};

std::vector<Facet> binned_facets(const surface::TriMesh& mesh) {
  std::vector<Facet> facets;
  facets.reserve(mesh.triangles.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vec3 n = normalized(surface::triangle_normal(mesh, t));
    const double offset = dot(n, mesh.points_mm[mesh.triangles[t][0]]);
    if (norm(n) == 0 || !(std::fabs(offset) < 1e6)) continue;
    const auto bin = [](double v, double width) { return static_cast<std::int32_t>(std::lround(v / width)); };
    facets.push_back(
        {{bin(n.x, normal_bin), bin(n.y, normal_bin), bin(n.z, normal_bin), bin(offset, offset_bin_mm)}, t});
  }
  std::sort(facets.begin(), facets.end(), [](const Facet& a, const Facet& b) {
    return a.bin < b.bin || (a.bin == b.bin && a.triangle < b.triangle);
  });
  return facets;
}

/// The fullest bins: a face may be shared by several that lie side by side, each a quarter of it at least.
std::vector<Candidate> candidates(const surface::TriMesh& mesh) {
  const std::vector<Facet> facets = binned_facets(mesh);
  std::vector<Candidate> all;
  for (std::size_t from = 0, to; from < facets.size(); from = to) {
    for (to = from; to < facets.size() && facets[to].bin == facets[from].bin;) ++to;
    if (to - from < min_triangles) continue;
    Candidate c;
    for (std::size_t i = from; i < to; ++i) {
      const Vec3 n = surface::triangle_normal(mesh, facets[i].triangle) * 0.5;
      c.normal += n;
      c.offset += dot(n, mesh.points_mm[mesh.triangles[facets[i].triangle][0]]);
      c.area += norm(n);
    }
    if (c.area >= min_area_mm2 / 4) all.push_back(c);
  }
  std::stable_sort(all.begin(), all.end(), [](const Candidate& a, const Candidate& b) { return a.area > b.area; });
  if (all.size() > max_candidates) all.resize(max_candidates);
  return all;
}

}  // namespace

std::vector<CutFace> cut_faces(const surface::TriMesh& mesh) {
  std::vector<CutFace> faces;
  for (const Candidate& c : candidates(mesh)) {
    const double length = norm(c.normal);
    if (!(length > 0)) continue;
    CutFace face{c.normal / length, c.offset / length, 0};
    if (std::any_of(faces.begin(), faces.end(), [&](const CutFace& f) {
          return dot(f.normal, face.normal) > 1 - 1e-5 &&
                 std::fabs(f.inside_mm(mesh.origin_mm) - face.offset_mm) < 2 * offset_bin_mm;
        }))
      continue;
    const auto height = [&](std::uint32_t i) { return dot(face.normal, mesh.points_mm[i]) - face.offset_mm; };
    bool supporting = true;
    for (std::uint32_t i = 0; supporting && i < mesh.points_mm.size(); ++i) supporting = height(i) <= flat_mm;
    if (!supporting) continue;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const auto& v = mesh.triangles[t];
      if (height(v[0]) > -flat_mm && height(v[1]) > -flat_mm && height(v[2]) > -flat_mm)
        face.area_mm2 += 0.5 * norm(surface::triangle_normal(mesh, t));
    }
    if (face.area_mm2 < min_area_mm2) continue;
    face.offset_mm += dot(face.normal, mesh.origin_mm);
    faces.push_back(face);
  }
  return faces;
}

}  // namespace trephine::boolean::detail
