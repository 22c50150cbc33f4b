// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/collapse_mesh.h"

#include <algorithm>

#include "base/parallel.h"

namespace trephine::meshing {
namespace {

constexpr std::int64_t grain = 32768;

/// Calls each(number of the piece, from, to) for pieces of 0..count-1, in parallel.
template <class Each>
void for_each_piece(std::size_t count, const Each& each) {
  parallel_for(0, static_cast<std::int64_t>(count), grain,
               [&](std::int64_t from, std::int64_t to) { each(from / grain, from, to); });
}

/// For each piece, how many items of the pieces before it are chosen; the last entry counts those of all pieces.
template <class Chosen>
std::vector<std::uint32_t> numbers_of(std::size_t count, const Chosen& chosen) {
  std::vector<std::uint32_t> before(count / grain + 2, 0);
  for_each_piece(count, [&](std::int64_t piece, std::int64_t from, std::int64_t to) {
    std::uint32_t n = 0;
    for (std::int64_t i = from; i < to; ++i) n += chosen(i);
    before[piece + 1] = n;
  });
  for (std::size_t p = 1; p < before.size(); ++p) before[p] += before[p - 1];
  return before;
}

}  // namespace

CollapseMesh::CollapseMesh(const surface::TriMesh& mesh)
    : points_mm_(mesh.points_mm.size()),
      triangles_(mesh.triangles),
      twin_(3 * mesh.triangles.size(), none),
      out_(mesh.points_mm.size(), none),
      killed_by_(mesh.points_mm.size(), none),
      changed_by_(mesh.triangles.size(), none),
      dead_(mesh.triangles.size(), 0),
      live_triangles_(mesh.triangles.size()) {
  for (std::uint32_t v = 0; v < points_mm_.size(); ++v) move(v, mesh.points_mm[v]);
  // The half-edges are sorted by the point that they leave. The twin of a half-edge is among those that leave its end.
  std::vector<std::uint32_t> begin(points_mm_.size() + 1, 0), leaving(twin_.size());
  for (const auto& t : triangles_)
    for (const std::uint32_t v : t) ++begin[v + 1];
  for (std::size_t v = 1; v < begin.size(); ++v) begin[v] += begin[v - 1];
  std::copy(begin.begin(), begin.end() - 1, out_.begin());
  for (std::uint32_t h = 0; h < twin_.size(); ++h) leaving[out_[from(h)]++] = h;
  parallel_for(0, static_cast<std::int64_t>(twin_.size()), 3 * grain, [&](std::int64_t first, std::int64_t last) {
    for (auto h = static_cast<std::uint32_t>(first); h < last; ++h) {
      const std::uint32_t u = from(h), v = to(h);
      for (std::uint32_t n = begin[v]; n < begin[v + 1]; ++n)
        if (to(leaving[n]) == u) twin_[h] = leaving[n];
    }
  });
  for (std::size_t v = 0; v < out_.size(); ++v) out_[v] = begin[v] < begin[v + 1] ? leaving[begin[v + 1] - 1] : none;
}

CollapseMesh::Log CollapseMesh::open_log(std::size_t capacity) {
  Log log;
  log.first_id = next_id_;
  next_id_ += static_cast<std::uint32_t>(capacity);
  return log;
}

void CollapseMesh::keep(Log&& log) {
  if (log.records.empty()) return;
  live_triangles_ -= 2 * log.records.size();
  logs_.push_back(std::move(log));
}

CollapseMesh::Record& CollapseMesh::record(std::uint32_t id) {
  const auto after = std::upper_bound(logs_.begin(), logs_.end(), id,
                                      [](std::uint32_t i, const Log& log) { return i < log.first_id; });
  Log& log = *(after - 1);
  return log.records[id - log.first_id];
}

bool CollapseMesh::keeps_manifold(std::uint32_t h) const {
  const std::uint32_t u = from(h), v = to(h);
  int around_u = 0, around_v = 0, common = 0;
  for_each_leaving(u, [&](std::uint32_t) { ++around_u; });
  for_each_leaving(v, [&](std::uint32_t e) {
    const std::uint32_t w = to(e);
    for_each_leaving(u, [&](std::uint32_t f) { common += to(f) == w; });
    ++around_v;
  });
  // The two ends may share the two points opposite the edge and no other; a tetrahedron would fold flat.
  return common == 2 && !(around_u == 3 && around_v == 3);
}

void CollapseMesh::collapse(std::uint32_t h, Vec3 place_mm, Log& log) {
  const auto id = log.first_id + static_cast<std::uint32_t>(log.records.size());
  const std::uint32_t u = from(h), v = to(h), g = twin_[h];
  const std::uint32_t t0 = h / 3, t1 = g / 3;
  const std::uint32_t a_to_v = twin_[next(h)], u_to_a = twin_[previous(h)];
  const std::uint32_t b_to_u = twin_[next(g)], v_to_b = twin_[previous(g)];
  log.records.push_back({h, points_mm_[u], static_cast<std::uint32_t>(log.journal.size())});

  for_each_leaving(v, [&](std::uint32_t e) {
    if (e / 3 != t0 && e / 3 != t1) triangles_[e / 3][e % 3] = u;
  });
  twin_[a_to_v] = u_to_a;
  twin_[u_to_a] = a_to_v;
  twin_[b_to_u] = v_to_b;
  twin_[v_to_b] = b_to_u;
  dead_[t0] = dead_[t1] = 1;
  killed_by_[v] = id;
  move(u, place_mm);
  out_[u] = u_to_a;
  out_[from(a_to_v)] = a_to_v;
  out_[from(b_to_u)] = b_to_u;
  for_each_leaving(u, [&](std::uint32_t e) {
    log.journal.push_back(changed_by_[e / 3]);
    changed_by_[e / 3] = id;
  });
}

void CollapseMesh::undo_now(std::uint32_t id) {
  Log& log =
      *(std::upper_bound(logs_.begin(), logs_.end(), id, [](std::uint32_t i, const Log& l) { return i < l.first_id; }) -
        1);
  Record& r = log.records[id - log.first_id];
  const std::uint32_t h = r.half_edge, g = twin_[h];
  const std::uint32_t t0 = h / 3, t1 = g / 3;
  const std::uint32_t u = from(h), v = to(h);
  const std::uint32_t u_to_a = twin_[previous(h)];
  std::size_t at = r.journal;
  out_[u] = u_to_a;  // the turn in which the journal was written
  for_each_leaving(u, [&](std::uint32_t e) { changed_by_[e / 3] = log.journal[at++]; });
  for (const std::uint32_t e : {next(h), previous(h), next(g), previous(g)}) twin_[twin_[e]] = e;
  dead_[t0] = dead_[t1] = 0;
  live_triangles_ += 2;
  killed_by_[v] = none;
  points_mm_[u] = r.old_place_mm;
  out_[u] = h;
  out_[v] = next(h);
  for_each_leaving(v, [&](std::uint32_t e) { triangles_[e / 3][e % 3] = v; });
  r.journal = none;
}

void CollapseMesh::undo(std::uint32_t collapse, const Visit& before, const Visit& undone) {
  std::vector<std::uint32_t> todo{collapse};
  while (!todo.empty()) {
    const std::uint32_t id = todo.back();
    const Record& r = record(id);
    if (r.journal == none) {
      todo.pop_back();
      continue;
    }
    const std::uint32_t u = from(r.half_edge), v = to(r.half_edge);
    std::uint32_t later = killed_by_[u];
    if (later == none)
      for_each_leaving(u, [&](std::uint32_t e) {
        if (changed_by_[e / 3] != id) later = changed_by_[e / 3];
      });
    if (later != none) {
      todo.push_back(later);
      continue;
    }
    before(u, v);
    undo_now(id);
    undone(u, v);
    todo.pop_back();
  }
}

std::vector<std::uint32_t> CollapseMesh::survivors() const {
  std::vector<std::uint32_t> into(points_mm_.size());
  for (std::uint32_t v = 0; v < into.size(); ++v) into[v] = v;
  for (const Log& log : logs_)
    for (const Record& r : log.records)
      if (r.journal != none) into[to(r.half_edge)] = from(r.half_edge);
  for (std::uint32_t v = 0; v < into.size(); ++v) {
    std::uint32_t end = v;
    while (into[end] != end) end = into[end];
    for (std::uint32_t at = v; into[at] != end;) {
      const std::uint32_t then = into[at];
      into[at] = end;
      at = then;
    }
  }
  return into;
}

surface::TriMesh CollapseMesh::to_mesh(Vec3 origin_mm, std::vector<std::uint32_t>* triangle_of) const {
  surface::TriMesh mesh;
  mesh.origin_mm = origin_mm;
  std::vector<std::uint32_t> where(points_mm_.size());
  const auto used = [this](std::int64_t v) { return live_point(static_cast<std::uint32_t>(v)) && out_[v] != none; };
  const auto live = [this](std::int64_t t) { return !dead_[t]; };
  const auto points = numbers_of(points_mm_.size(), used), triangles = numbers_of(triangles_.size(), live);
  mesh.points_mm.resize(points.back());
  mesh.triangles.resize(triangles.back());
  if (triangle_of) triangle_of->resize(triangles.back());
  for_each_piece(points_mm_.size(), [&](std::int64_t piece, std::int64_t from, std::int64_t to) {
    std::uint32_t n = points[piece];
    for (std::int64_t v = from; v < to; ++v) {
      if (!used(v)) continue;
      mesh.points_mm[n] = point_mm(static_cast<std::uint32_t>(v));
      where[v] = n++;
    }
  });
  for_each_piece(triangles_.size(), [&](std::int64_t piece, std::int64_t from, std::int64_t to) {
    std::uint32_t n = triangles[piece];
    for (std::int64_t t = from; t < to; ++t) {
      if (!live(t)) continue;
      const auto& v = triangles_[t];
      if (triangle_of) (*triangle_of)[n] = static_cast<std::uint32_t>(t);
      mesh.triangles[n++] = {where[v[0]], where[v[1]], where[v[2]]};
    }
  });
  return mesh;
}

}  // namespace trephine::meshing
