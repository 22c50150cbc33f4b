// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/pi.h"
#include "base/refusal.h"
#include "tetra/tetra_mesh.h"

namespace trephine::tetra {
namespace {

double rank(const std::vector<double>& sorted, double share) {
  const double at = std::ceil(share * double(sorted.size()));
  return sorted[std::size_t(std::clamp(at - 1, 0.0, double(sorted.size() - 1)))];
}

}  // namespace

double volume_mm3(const TetraMesh& mesh, std::size_t n) {
  const auto& t = mesh.tetrahedra[n];
  const Vec3 a = mesh.points_mm[t[0]];
  return dot(cross(mesh.points_mm[t[1]] - a, mesh.points_mm[t[2]] - a), mesh.points_mm[t[3]] - a) / 6;
}

TetraQuality quality_of(const TetraMesh& mesh) {
  TetraQuality q;
  std::vector<double> least, ratio;
  for (std::size_t n = 0; n < mesh.tetrahedra.size(); ++n) {
    const double volume = volume_mm3(mesh, n);
    if (!(volume > 0))
      throw refusal("tetrahedra", "one has no volume, or is turned inside out", {"another `size_mm` makes others"});
    std::array<Vec3, 4> p;
    for (std::size_t c = 0; c < 4; ++c) p[c] = mesh.points_mm[mesh.tetrahedra[n][c]];
    // The faces' normals, inwards, twice the area long.
    const std::array<Vec3, 4> normal{cross(p[3] - p[1], p[2] - p[1]), cross(p[2] - p[0], p[3] - p[0]),
                                     cross(p[3] - p[0], p[1] - p[0]), cross(p[1] - p[0], p[2] - p[0])};
    double small = 180, area = 0;
    for (std::size_t a = 0; a < 4; ++a) {
      area += norm(normal[a]) / 2;
      for (std::size_t b = a + 1; b < 4; ++b) {
        const double cosine = -dot(normalized(normal[a]), normalized(normal[b]));
        const double deg = std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / pi;
        small = std::min(small, deg);
        q.dihedral_max_deg = std::max(q.dihedral_max_deg, deg);
      }
    }
    // The outer ball's radius by the products of opposite edges.
    const double x = norm(p[1] - p[0]) * norm(p[3] - p[2]), y = norm(p[2] - p[0]) * norm(p[3] - p[1]),
                 z = norm(p[3] - p[0]) * norm(p[2] - p[1]);
    const double outer =
        std::sqrt(std::max(0.0, (x + y + z) * (x + y - z) * (x - y + z) * (y + z - x))) / (24 * volume);
    least.push_back(small);
    ratio.push_back(outer > 0 ? 3 * (3 * volume / area) / outer : 0);
  }
  if (least.empty()) return q;
  std::sort(least.begin(), least.end());
  std::sort(ratio.begin(), ratio.end());
  q.dihedral_min_deg = least.front();
  q.dihedral_p1_deg = rank(least, 0.01);
  q.dihedral_median_deg = rank(least, 0.5);
  q.ratio_min = ratio.front();
  q.ratio_p1 = rank(ratio, 0.01);
  q.ratio_median = rank(ratio, 0.5);
  return q;
}

surface::TriMesh borders_of(const TetraMesh& mesh, std::uint8_t region) {
  surface::TriMesh out;
  constexpr std::uint32_t none = ~std::uint32_t{0};
  std::vector<std::uint32_t> number(mesh.points_mm.size(), none);
  for (std::size_t n = 0; n < mesh.borders.size(); ++n) {
    if (region != 0 && mesh.between[n][0] != region) continue;
    std::array<std::uint32_t, 3> t{};
    for (std::size_t c = 0; c < 3; ++c) {
      std::uint32_t& at = number[mesh.borders[n][c]];
      if (at == none) {
        at = std::uint32_t(out.points_mm.size());
        out.points_mm.push_back(mesh.points_mm[mesh.borders[n][c]]);
      }
      t[c] = at;
    }
    out.triangles.push_back(t);
  }
  return out;
}

}  // namespace trephine::tetra
