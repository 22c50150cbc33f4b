// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/fault_places.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "surface/triangle_tree.h"

namespace trephine::surface {
namespace {

using Corners = std::array<Vec3, 3>;

void note(std::vector<Vec3>& list, Vec3 at) {
  if (list.size() < FaultPlaces::limit) list.push_back(at);
}

Vec3 middle_of(const TriMesh& m, std::uint32_t t) {
  const auto& v = m.triangles[t];
  return m.origin_mm + (m.points_mm[v[0]] + m.points_mm[v[1]] + m.points_mm[v[2]]) / 3;
}

/// The point of the first segment that is nearest to the second (Ericson, Real-Time Collision Detection, 5.1.9).
Vec3 nearest_on_segment(Vec3 p, Vec3 q, Vec3 a, Vec3 b, double& squared) {
  const Vec3 u = q - p, v = b - a, w = p - a;
  const double uu = dot(u, u), vv = dot(v, v), uv = dot(u, v), uw = dot(u, w), vw = dot(v, w);
  const auto unit = [](double x) { return std::isfinite(x) ? std::clamp(x, 0.0, 1.0) : 0.0; };
  double s = unit((uv * vw - uw * vv) / (uu * vv - uv * uv));
  const double t = unit((uv * s + vw) / vv);
  s = unit((uv * t - uw) / uu);
  const Vec3 on = p + u * s;
  const Vec3 gap = on - (a + v * t);
  squared = dot(gap, gap);
  return on;
}

/// Points that lie in both triangles, found from their corners and edges.
struct Contacts {
  double nearest2 = std::numeric_limits<double>::infinity();  ///< the best contact's gap, squared
  double tolerance2 = 0;
  std::vector<Vec3> at;

  void add(Vec3 p, double gap2) {
    if (gap2 > std::max(nearest2, tolerance2)) return;
    if (gap2 < nearest2 && nearest2 > tolerance2) at.clear();
    nearest2 = std::min(nearest2, gap2);
    at.push_back(p);
  }
};

/// The points at which the edges of a pass through the inside of b.
void add_crossings(const Corners& a, const Corners& b, Contacts& found) {
  const Vec3 normal = cross(b[1] - b[0], b[2] - b[0]);
  for (int e = 0; e < 3; ++e) {
    const Vec3 p = a[e], q = a[(e + 1) % 3];
    const double dp = dot(p - b[0], normal), dq = dot(q - b[0], normal);
    if ((dp > 0) == (dq > 0) || dp == dq) continue;
    const Vec3 on = p + (q - p) * (dp / (dp - dq));
    const Vec3 gap = on - closest_on_triangle(on, b[0], b[1], b[2]);
    found.add(on, dot(gap, gap));
  }
}

}  // namespace

void locate_topology_faults(const TriMesh& mesh, const Incidence& incidence, FaultPlaces& places) {
  for_each_edge(mesh, incidence, [&](std::uint32_t low, auto from, auto to) {
    const Vec3 middle = mesh.origin_mm + (mesh.points_mm[low] + mesh.points_mm[from->other]) / 2;
    if (to - from == 1) note(places.open_edges, middle);
    if (to - from > 2) note(places.nonmanifold_edges, middle);
    if (to - from == 2 && from->forward == (from + 1)->forward) note(places.misoriented_edges, middle);
  });
  std::vector<std::pair<std::array<std::uint32_t, 3>, std::uint32_t>> around;
  for (std::uint32_t p = 0; p < mesh.points_mm.size(); ++p) {
    if (count_fans(mesh, incidence, p) > 1) note(places.nonmanifold_points, mesh.world_mm(p));
    around.clear();
    for (std::uint32_t n = incidence.begin[p]; n < incidence.begin[p + 1]; ++n) {
      auto t = mesh.triangles[incidence.triangle[n]];
      std::sort(t.begin(), t.end());
      if (t[0] == p && t[0] != t[1] && t[1] != t[2]) around.push_back({t, incidence.triangle[n]});
    }
    std::sort(around.begin(), around.end());
    for (std::size_t i = 1; i < around.size(); ++i)
      if (around[i].first == around[i - 1].first) note(places.duplicate_triangles, middle_of(mesh, around[i].second));
  }
}

std::vector<double> piece_volumes(const TriMesh& mesh, const std::vector<int>& piece_of, int pieces) {
  std::vector<double> volume(pieces);
  std::vector<std::uint32_t> about(pieces, 0xffffffffu);
  for (std::size_t t = 0; t < piece_of.size(); ++t) {
    const auto& v = mesh.triangles[t];
    std::uint32_t& o = about[piece_of[t]];
    if (o == 0xffffffffu) o = v[0];
    const Vec3 p = mesh.points_mm[o];
    volume[piece_of[t]] += dot(mesh.points_mm[v[0]] - p, cross(mesh.points_mm[v[1]] - p, mesh.points_mm[v[2]] - p));
  }
  return volume;
}

Vec3 place_of_intersection_mm(const TriMesh& mesh, std::uint32_t s, std::uint32_t t) {
  const auto &is = mesh.triangles[s], &it = mesh.triangles[t];
  Corners a, b;
  std::vector<Vec3> shared;
  double longest2 = 0;
  for (int i = 0; i < 3; ++i) {
    a[i] = mesh.points_mm[is[i]];
    b[i] = mesh.points_mm[it[i]];
    if (std::find(it.begin(), it.end(), is[i]) != it.end()) shared.push_back(a[i]);
  }
  for (int i = 0; i < 3; ++i)
    for (const Corners* c : {&a, &b}) {
      const Vec3 side = (*c)[(i + 1) % 3] - (*c)[i];
      longest2 = std::max(longest2, dot(side, side));
    }
  const auto is_shared = [&](Vec3 p) {
    if (shared.size() == 2) {  // on the edge that they share
      double gap2 = 0;
      nearest_on_segment(shared[0], shared[1], p, p, gap2);
      return gap2 <= 1e-20 * longest2;
    }
    return !shared.empty() && dot(p - shared[0], p - shared[0]) <= 1e-20 * longest2;
  };
  Contacts found;
  found.tolerance2 = 1e-22 * longest2;
  const auto consider = [&](Vec3 p, double gap2) {
    if (!is_shared(p)) found.add(p, gap2);
  };
  Contacts crossings;
  crossings.tolerance2 = found.tolerance2;
  add_crossings(a, b, crossings);
  add_crossings(b, a, crossings);
  for (const Vec3 p : crossings.at) consider(p, crossings.nearest2);
  if (found.at.empty() || found.nearest2 > found.tolerance2) {  // in one plane, or touching
    for (int i = 0; i < 3; ++i) {
      const Vec3 ga = a[i] - closest_on_triangle(a[i], b[0], b[1], b[2]),
                 gb = b[i] - closest_on_triangle(b[i], a[0], a[1], a[2]);
      consider(a[i], dot(ga, ga));
      consider(b[i], dot(gb, gb));
      for (int j = 0; j < 3; ++j) {
        double gap2 = 0;
        const Vec3 on = nearest_on_segment(a[i], a[(i + 1) % 3], b[j], b[(j + 1) % 3], gap2);
        consider(on, gap2);
      }
    }
    if (found.at.empty()) return middle_of(mesh, t);
    return mesh.origin_mm + found.at.front();
  }
  Vec3 sum;
  for (const Vec3 p : found.at) sum += p;
  return mesh.origin_mm + sum / double(found.at.size());
}

}  // namespace trephine::surface
