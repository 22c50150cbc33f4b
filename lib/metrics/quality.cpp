// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/quality.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/rank.h"
#include "surface/incidence.h"

namespace trephine::metrics {
namespace {

Quantiles quantiles_of(std::vector<double>& v) {
  Quantiles q;
  if (v.empty()) return q;
  const auto at = [&](std::size_t percent) {
    return value_at_rank(v, std::max<std::size_t>(1, (v.size() * percent + 99) / 100) - 1);
  };
  q.min = *std::min_element(v.begin(), v.end());
  q.max = *std::max_element(v.begin(), v.end());
  q.median = at(50);
  q.p99 = at(99);
  return q;
}

}  // namespace

MeshMeasures measure_mesh(const surface::TriMesh& mesh) {
  surface::check_mesh(mesh);
  MeshMeasures m;
  m.topology = surface::topology_of(mesh);
  m.area_mm2 = surface::area_mm2(mesh);
  m.volume_mm3 = surface::volume_mm3(mesh);

  std::vector<double> lengths, aspects;
  lengths.reserve(m.topology.edges);
  surface::for_each_edge(mesh, surface::Incidence(mesh), [&](std::uint32_t low, auto from, auto) {
    lengths.push_back(norm(mesh.points_mm[from->other] - mesh.points_mm[low]));
  });
  aspects.reserve(mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& v = mesh.triangles[t];
    const Vec3 &a = mesh.points_mm[v[0]], &b = mesh.points_mm[v[1]], &c = mesh.points_mm[v[2]];
    const double ab = norm(b - a), bc = norm(c - b), ca = norm(a - c);
    const double area = norm(surface::triangle_normal(mesh, t)) / 2;
    const double aspect = std::max({ab, bc, ca}) * (ab + bc + ca) / (4 * std::sqrt(3.0) * area);
    if (area > 0 && std::isfinite(aspect)) aspects.push_back(aspect);
  }
  m.edge_length_mm = quantiles_of(lengths);
  m.aspect_ratio = quantiles_of(aspects);
  return m;
}

}  // namespace trephine::metrics
