// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/enclosed.h"

#include <algorithm>
#include <vector>

#include "surface/bounds.h"
#include "surface/incidence.h"

namespace trephine::meshing {
namespace {

struct Component {
  std::uint32_t first = 0;               ///< triangle
  std::vector<std::uint32_t> triangles;  ///< where it looks inwards
  double volume = 0;
  surface::Bounds box;
};

bool within(const surface::Bounds& a, const surface::Bounds& b) {
  for (int i = 0; i < 3; ++i)
    if (a.min_mm[i] < b.min_mm[i] || a.max_mm[i] > b.max_mm[i]) return false;
  return true;
}

/// Parity of the crossings along a skew ray. The direction lies in no lattice plane, so the ray practically never meets
/// an edge.
bool encloses(const surface::TriMesh& mesh, const Component& shell, Vec3 p) {
  const Vec3 d{0.8017837257, 0.5345224838, 0.2672612419 + 0.0123456789};
  bool inside = false;
  for (const std::uint32_t t : shell.triangles) {
    const auto& v = mesh.triangles[t];
    const Vec3 a = mesh.points_mm[v[0]] - p, b = mesh.points_mm[v[1]] - p, c = mesh.points_mm[v[2]] - p;
    const double u = dot(d, cross(c, b)), w = dot(d, cross(a, c)), s = dot(d, cross(b, a));
    if (!((u >= 0 && w >= 0 && s >= 0) || (u <= 0 && w <= 0 && s <= 0))) continue;
    const double sum = u + w + s;
    if (sum == 0) continue;
    const double distance = (u * dot(a, d) + w * dot(b, d) + s * dot(c, d)) / sum;
    if (distance > 0) inside = !inside;
  }
  return inside;
}

}  // namespace

int drop_cavities(surface::TriMesh& mesh, int& pieces_left, const Progress& progress) {
  std::vector<int> label;
  const int count = surface::label_fan_components(mesh, label);
  pieces_left = count;
  if (count < 2) return 0;
  std::vector<Component> components(count);
  const Vec3 o = mesh.points_mm[mesh.triangles.front()[0]];
  for (std::uint32_t t = static_cast<std::uint32_t>(mesh.triangles.size()); t-- > 0;) components[label[t]].first = t;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    Component& c = components[label[t]];
    Vec3 p[3];
    for (int k = 0; k < 3; ++k) {
      p[k] = mesh.points_mm[mesh.triangles[t][k]];
      surface::include(c.box, p[k]);
      p[k] = p[k] - o;
    }
    c.volume += dot(p[0], cross(p[1], p[2])) / 6;
  }
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    if (components[label[t]].volume < 0) components[label[t]].triangles.push_back(t);
  std::vector<char> drop(count, 0);
  for (int c = 0; c < count; ++c) drop[c] = components[c].volume < 0;
  for (int c = 0; c < count; ++c) {
    if (!(components[c].volume < 0)) continue;
    progress.check();
    for (int other = 0; other < count; ++other)
      if (!drop[other] && within(components[other].box, components[c].box))
        drop[other] = encloses(mesh, components[c], mesh.points_mm[mesh.triangles[components[other].first][0]]);
  }
  const int dropped = static_cast<int>(std::count(drop.begin(), drop.end(), 1));
  if (dropped == 0) return 0;
  std::size_t kept = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    if (!drop[label[t]]) mesh.triangles[kept++] = mesh.triangles[t];
  mesh.triangles.resize(kept);
  surface::drop_unused_points(mesh);
  pieces_left = count - dropped;
  return dropped;
}

}  // namespace trephine::meshing
