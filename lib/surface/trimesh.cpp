// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/trimesh.h"

#include <algorithm>
#include <string>
#include <utility>

#include "base/disjoint_sets.h"
#include "base/error.h"
#include "base/text.h"
#include "surface/bounds.h"
#include "surface/incidence.h"

namespace trephine::surface {

Bounds bounds_of(const TriMesh& mesh) {
  Bounds b;
  for (std::size_t i = 0; i < mesh.points_mm.size(); ++i) include(b, mesh.world_mm(i));
  return b;
}

void check_mesh(const TriMesh& mesh) {
  const auto fail = [](const std::string& field, const std::string& what) {
    throw Error(ExitCode::bad_input, "", field, what);
  };
  if (!is_finite(mesh.origin_mm)) fail("origin", "must be finite");
  if (mesh.points_mm.size() >= 0xffffffffu) fail("points", "more than 2^32 - 2 points");
  if (mesh.triangles.size() >= 0xffffffffu / 3) fail("triangles", "more than 1,431,655,764 triangles");
  for (std::size_t i = 0; i < mesh.points_mm.size(); ++i)
    if (!is_finite(mesh.points_mm[i])) fail("point " + std::to_string(i), "must be finite");
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::uint32_t v : mesh.triangles[t])
      if (v >= mesh.points_mm.size())
        fail("triangle " + std::to_string(t),
             "index " + std::to_string(v) + ", there are " + std::to_string(mesh.points_mm.size()) + " points");
  if (!mesh.normals.empty()) {
    if (mesh.normals.size() != mesh.points_mm.size())
      fail("normals",
           std::to_string(mesh.normals.size()) + " for " + std::to_string(mesh.points_mm.size()) + " points");
    for (std::size_t i = 0; i < mesh.normals.size(); ++i)
      if (!is_finite(mesh.normals[i])) fail("normal " + std::to_string(i), "must be finite");
  }
}

Vec3 triangle_normal(const TriMesh& mesh, std::size_t triangle) {
  const auto& t = mesh.triangles[triangle];
  const Vec3 a = mesh.points_mm[t[0]];
  return cross(mesh.points_mm[t[1]] - a, mesh.points_mm[t[2]] - a);
}

double area_mm2(const TriMesh& mesh) {
  double twice = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) twice += norm(triangle_normal(mesh, t));
  return twice / 2;
}

double volume_mm3(const TriMesh& mesh) {
  if (mesh.points_mm.empty()) return 0;
  // Relative to a point of the mesh, so that a far origin costs no digits.
  const Vec3 o = mesh.points_mm.front();
  double six = 0;
  for (const auto& t : mesh.triangles)
    six += dot(mesh.points_mm[t[0]] - o, cross(mesh.points_mm[t[1]] - o, mesh.points_mm[t[2]] - o));
  return six / 6;
}

void drop_unused_points(TriMesh& mesh) {
  constexpr std::uint32_t unused = 0xffffffffu;
  std::vector<std::uint32_t> where(mesh.points_mm.size(), unused);
  for (const auto& t : std::as_const(mesh).triangles)
    for (const std::uint32_t v : t) where[v] = 0;
  if (std::find(where.begin(), where.end(), unused) == where.end()) return;
  std::uint32_t count = 0;
  for (std::size_t i = 0; i < where.size(); ++i) {
    if (where[i] == unused) continue;
    mesh.points_mm[count] = mesh.points_mm[i];
    if (!mesh.normals.empty()) mesh.normals[count] = mesh.normals[i];
    where[i] = count++;
  }
  mesh.points_mm.resize(count);
  if (!mesh.normals.empty()) mesh.normals.resize(count);
  for (auto& t : mesh.triangles)
    for (auto& v : t) v = where[v];
}

int label_components(const TriMesh& mesh, std::vector<int>& component_of_triangle) {
  DisjointSets sets(mesh.triangles.size());
  for_each_edge(mesh, Incidence(mesh), [&](std::uint32_t, auto from, auto to) {
    for (auto use = from + 1; use != to; ++use) sets.unite(from->triangle, use->triangle);
  });
  component_of_triangle.assign(mesh.triangles.size(), 0);
  int count = 0;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const std::uint32_t first = sets.find(t);
    component_of_triangle[t] = first == t ? count++ : component_of_triangle[first];
  }
  return count;
}

int label_fan_components(const TriMesh& mesh, std::vector<int>& component_of_triangle) {
  DisjointSets sets(mesh.points_mm.size());
  for (const auto& t : mesh.triangles) {
    sets.unite(t[0], t[1]);
    sets.unite(t[1], t[2]);
  }
  constexpr int unknown = -1;
  std::vector<int> number(mesh.points_mm.size(), unknown);
  component_of_triangle.resize(mesh.triangles.size());
  int count = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    int& n = number[sets.find(mesh.triangles[t][0])];
    if (n == unknown) n = count++;
    component_of_triangle[t] = n;
  }
  return count;
}

namespace {

int keep_large(TriMesh& mesh, double min_volume_mm3, const std::vector<int>& component, int count) {
  if (count < 2) return 0;
  const Vec3 o = mesh.points_mm[mesh.triangles.front()[0]];
  std::vector<double> volume(count, 0.0);
  for (std::size_t n = 0; n < mesh.triangles.size(); ++n) {
    const auto& t = mesh.triangles[n];
    volume[component[n]] +=
        dot(mesh.points_mm[t[0]] - o, cross(mesh.points_mm[t[1]] - o, mesh.points_mm[t[2]] - o)) / 6;
  }
  for (double& v : volume) v = std::abs(v);
  const auto largest = std::max_element(volume.begin(), volume.end()) - volume.begin();
  std::vector<char> keep(count);
  int dropped = 0;
  for (int c = 0; c < count; ++c) {
    keep[c] = c == largest || volume[c] >= min_volume_mm3;
    dropped += !keep[c];
  }
  if (dropped == 0) return 0;
  std::size_t kept = 0;
  for (std::size_t n = 0; n < mesh.triangles.size(); ++n)
    if (keep[component[n]]) mesh.triangles[kept++] = mesh.triangles[n];
  mesh.triangles.resize(kept);
  drop_unused_points(mesh);
  return dropped;
}

}  // namespace

int keep_large_components(TriMesh& mesh, double min_volume_mm3) {
  std::vector<int> component;
  const int count = label_components(mesh, component);
  return keep_large(mesh, min_volume_mm3, component, count);
}

int keep_large_fan_components(TriMesh& mesh, double min_volume_mm3) {
  std::vector<int> component;
  const int count = label_fan_components(mesh, component);
  return keep_large(mesh, min_volume_mm3, component, count);
}

}  // namespace trephine::surface
