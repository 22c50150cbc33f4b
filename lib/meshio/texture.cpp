// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshio/texture.h"

#include <cmath>
#include <utility>

#include "base/pi.h"

namespace trephine::meshio {
namespace {

// Rounds to the digits that do not depend on the C library.
double rounded(double v) { return std::round(v * 1e6) / 1e6; }

Vec3 area_centroid(const surface::TriMesh& mesh) {
  Vec3 sum;
  double area = 0;
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.points_mm[t[0]], b = mesh.points_mm[t[1]], c = mesh.points_mm[t[2]];
    const double twice = norm(cross(b - a, c - a));
    sum += (a + b + c) * (twice / 3);
    area += twice;
  }
  return area > 0 ? sum / area : sum;
}

struct Direction {
  double u = 0, v = 0.5;
  bool on_axis = false;
};

Direction direction_of(Vec3 d) {
  Direction r;
  const double across = std::hypot(d.x, d.y), length = norm(d);
  if (!(length > 0)) {
    r.on_axis = true;
    return r;
  }
  r.v = rounded(0.5 + std::atan2(d.z, across) / pi);
  r.on_axis = across <= 1e-9 * length;
  // The point at the back belongs to u = 0; u = 1 is the same place.
  if (!r.on_axis) r.u = rounded(0.5 + std::atan2(d.x, -d.y) / (2 * pi));
  if (r.u >= 1) r.u -= 1;
  return r;
}

// Moves the u of the corners that have one (1 to 3 of them) by whole turns, so that they lie as near together as
// possible: the circle is cut at its widest gap.
void unwrap(double* u, int count) {
  int order[3] = {0, 1, 2};
  const auto sort_pair = [&](int a, int b) {
    if (u[order[b]] < u[order[a]]) std::swap(order[a], order[b]);
  };
  if (count > 1) sort_pair(0, 1);
  if (count > 2) {
    sort_pair(1, 2);
    sort_pair(0, 1);
  }
  int cut = 0;  // the first after the widest gap
  double widest = u[order[0]] + 1 - u[order[count - 1]];
  for (int i = 1; i < count; ++i)
    if (u[order[i]] - u[order[i - 1]] > widest) {
      widest = u[order[i]] - u[order[i - 1]];
      cut = i;
    }
  for (int i = 0; i < cut; ++i) u[order[i]] += 1;
}

}  // namespace

TextureMap spherical_texture(const surface::TriMesh& mesh) {
  const Vec3 centre = area_centroid(mesh);
  std::vector<Direction> directions;
  directions.reserve(mesh.points_mm.size());
  for (const Vec3 p : mesh.points_mm) directions.push_back(direction_of(p - centre));

  TextureMap map;
  map.triangles.reserve(mesh.triangles.size());
  // For each point of the mesh, the first of its texture points; the others follow in a chain.
  constexpr std::uint32_t none = 0xffffffffu;
  std::vector<std::uint32_t> first(mesh.points_mm.size(), none), next;
  const auto texture_point = [&](std::uint32_t p, double u, double v) {
    std::uint32_t* link = &first[p];
    for (; *link != none; link = &next[*link])
      if (map.points[*link].u == u) return *link;
    const auto made = std::uint32_t(map.points.size());
    *link = made;
    map.points.push_back({p, u, v});
    next.push_back(none);
    return made;
  };
  for (const auto& t : mesh.triangles) {
    double known[3];
    int count = 0;
    for (const std::uint32_t p : t)
      if (!directions[p].on_axis) known[count++] = directions[p].u;
    double mean = 0;
    if (count > 0) unwrap(known, count);
    for (int i = 0; i < count; ++i) mean += known[i] / count;
    std::array<std::uint32_t, 3> corners;
    int at = 0;
    for (int c = 0; c < 3; ++c) {
      const Direction& d = directions[t[c]];
      corners[c] = texture_point(t[c], rounded(d.on_axis ? mean : known[at++]), d.v);
    }
    map.triangles.push_back(corners);
  }
  return map;
}

}  // namespace trephine::meshio
