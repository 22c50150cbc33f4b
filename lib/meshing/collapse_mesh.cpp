// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/collapse_mesh.h"

#include "surface/incidence.h"

namespace trephine {

CollapseMesh::CollapseMesh(const TriMesh& mesh)
    : points_mm_(mesh.points_mm),
      triangles_(mesh.triangles),
      twin_(3 * mesh.triangles.size(), none),
      out_(mesh.points_mm.size(), none),
      killed_by_(mesh.points_mm.size(), none),
      changed_by_(mesh.triangles.size(), none),
      mark_(mesh.points_mm.size(), 0),
      dead_(mesh.triangles.size(), 0),
      live_triangles_(mesh.triangles.size()) {
  const auto half_edge = [&](std::uint32_t t, std::uint32_t start) {
    const auto& v = triangles_[t];
    return 3 * t + (v[0] == start ? 0 : v[1] == start ? 1 : 2);
  };
  for_each_edge(mesh, Incidence(mesh), [&](std::uint32_t low, auto first, auto) {
    const auto& second = *(first + 1);
    const std::uint32_t a = half_edge(first->triangle, first->forward ? low : first->other);
    const std::uint32_t b = half_edge(second.triangle, second.forward ? low : second.other);
    twin_[a] = b;
    twin_[b] = a;
  });
  for (std::uint32_t h = 0; h < twin_.size(); ++h) out_[from(h)] = h;
}

bool CollapseMesh::keeps_manifold(std::uint32_t h) {
  const std::uint32_t u = from(h), v = to(h);
  ++stamp_;
  int around_u = 0, around_v = 0, common = 0;
  for_each_leaving(u, [&](std::uint32_t e) {
    mark_[to(e)] = stamp_;
    ++around_u;
  });
  for_each_leaving(v, [&](std::uint32_t e) {
    common += mark_[to(e)] == stamp_;
    ++around_v;
  });
  // The two ends may share the two points opposite the edge and no other; a tetrahedron would fold flat.
  return common == 2 && !(around_u == 3 && around_v == 3);
}

void CollapseMesh::collapse(std::uint32_t h, Vec3 place_mm) {
  const auto id = static_cast<std::uint32_t>(records_.size());
  const std::uint32_t u = from(h), v = to(h), g = twin_[h];
  const std::uint32_t t0 = h / 3, t1 = g / 3;
  const std::uint32_t a_to_v = twin_[next(h)], u_to_a = twin_[previous(h)];
  const std::uint32_t b_to_u = twin_[next(g)], v_to_b = twin_[previous(g)];
  records_.push_back({h, points_mm_[u], journal_.size(), false});

  for_each_leaving(v, [&](std::uint32_t e) {
    if (e / 3 != t0 && e / 3 != t1) triangles_[e / 3][e % 3] = u;
  });
  twin_[a_to_v] = u_to_a;
  twin_[u_to_a] = a_to_v;
  twin_[b_to_u] = v_to_b;
  twin_[v_to_b] = b_to_u;
  dead_[t0] = dead_[t1] = 1;
  live_triangles_ -= 2;
  killed_by_[v] = id;
  points_mm_[u] = place_mm;
  out_[u] = u_to_a;
  out_[from(a_to_v)] = a_to_v;
  out_[from(b_to_u)] = b_to_u;
  for_each_leaving(u, [&](std::uint32_t e) {
    journal_.push_back(changed_by_[e / 3]);
    changed_by_[e / 3] = id;
  });
}

void CollapseMesh::undo_now(std::uint32_t id) {
  Record& r = records_[id];
  const std::uint32_t h = r.half_edge, g = twin_[h];
  const std::uint32_t t0 = h / 3, t1 = g / 3;
  const std::uint32_t u = from(h), v = to(h);
  const std::uint32_t u_to_a = twin_[previous(h)];
  std::size_t at = r.journal;
  out_[u] = u_to_a;  // the turn in which the journal was written
  for_each_leaving(u, [&](std::uint32_t e) { changed_by_[e / 3] = journal_[at++]; });
  for (const std::uint32_t e : {next(h), previous(h), next(g), previous(g)}) twin_[twin_[e]] = e;
  dead_[t0] = dead_[t1] = 0;
  live_triangles_ += 2;
  killed_by_[v] = none;
  points_mm_[u] = r.old_place_mm;
  out_[u] = h;
  out_[v] = next(h);
  for_each_leaving(v, [&](std::uint32_t e) { triangles_[e / 3][e % 3] = v; });
  r.undone = true;
}

void CollapseMesh::undo(std::uint32_t collapse, const std::function<void(std::uint32_t, std::uint32_t)>& undone) {
  std::vector<std::uint32_t> todo{collapse};
  while (!todo.empty()) {
    const std::uint32_t id = todo.back();
    const Record& r = records_[id];
    if (r.undone) {
      todo.pop_back();
      continue;
    }
    const std::uint32_t u = from(r.half_edge), v = to(r.half_edge);
    std::uint32_t before = killed_by_[u];
    if (before == none)
      for_each_leaving(u, [&](std::uint32_t e) {
        if (changed_by_[e / 3] != id) before = changed_by_[e / 3];
      });
    if (before != none) {
      todo.push_back(before);
      continue;
    }
    undo_now(id);
    undone(u, v);
    todo.pop_back();
  }
}

TriMesh CollapseMesh::to_mesh(Vec3 origin_mm, std::vector<std::uint32_t>* triangle_of) const {
  TriMesh mesh;
  mesh.origin_mm = origin_mm;
  std::vector<std::uint32_t> where(points_mm_.size(), none);
  for (std::uint32_t v = 0; v < points_mm_.size(); ++v) {
    if (!live_point(v) || out_[v] == none) continue;
    where[v] = static_cast<std::uint32_t>(mesh.points_mm.size());
    mesh.points_mm.push_back(points_mm_[v]);
  }
  mesh.triangles.reserve(live_triangles_);
  if (triangle_of) triangle_of->clear();
  for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
    if (dead_[t]) continue;
    const auto& v = triangles_[t];
    mesh.triangles.push_back({where[v[0]], where[v[1]], where[v[2]]});
    if (triangle_of) triangle_of->push_back(t);
  }
  return mesh;
}

}  // namespace trephine
