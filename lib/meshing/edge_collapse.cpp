// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/edge_collapse.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"

namespace trephine {
namespace {

/// Weight of the points beside that of the planes: enough to fix a place on a flat part, too little to matter
/// elsewhere.
constexpr double point_weight = 1e-3;
/// A triangle's normal may turn by at most the angle with this cosine, in one collapse.
constexpr double least_turn_cosine = 0.2;
/// Two neighbours may not fold over each other more sharply than this.
constexpr double least_fold_cosine = -0.9;
/// Least compactness (1: equilateral), unless there was a worse triangle before.
constexpr double least_compactness = 0.05;
/// Share of the limit that the carried points may use; the rest is for what lies between them.
constexpr double carried_share = 0.95;
/// Share of the limit that a carried point must be away for the triangles to be sampled.
constexpr double some_way = 0.5;
/// A sweep takes this share of the edges; sweeps end at so many times the target, such a part of the input, or this
/// count.
constexpr double cheap_share = 0.3, swept_to_target = 2.5;
constexpr std::size_t swept_to_share = 8, swept_to_count = 20000;

double compactness(Vec3 a, Vec3 b, Vec3 c) {
  const double squares = dot(b - a, b - a) + dot(c - b, c - b) + dot(a - c, a - c);
  return squares > 0 ? 2 * std::sqrt(3.0) * norm(cross(b - a, c - a)) / squares : 0;
}

}  // namespace

EdgeCollapse::EdgeCollapse(const TriMesh& input, const DeviationMeter& meter, double limit_mm, double step_mm)
    : meter_(meter),
      mesh_(input),
      squared_limit_(limit_mm > 0 ? limit_mm * limit_mm * carried_share * carried_share
                                  : std::numeric_limits<double>::infinity()),
      step_(step_mm),
      carried_(input),
      quadrics_(input.points_mm.size()),
      versions_(input.points_mm.size(), 0),
      locked_(input.points_mm.size(), 0),
      near_(input.triangles.size()) {
  for (std::size_t t = 0; t < near_.size(); ++t) near_[t] = input.triangles[t][0];
  for (std::size_t t = 0; t < input.triangles.size(); ++t) {
    const Vec3 n = triangle_normal(input, t);
    const double weight = norm(n) / 6;
    for (const std::uint32_t v : input.triangles[t]) {
      quadrics_[v].add_plane(normalized(n), input.points_mm[v], weight);
      quadrics_[v].add_point(input.points_mm[v], weight * point_weight);
    }
  }
}

Vec3 EdgeCollapse::place(std::uint32_t u, std::uint32_t v, double& cost) const {
  Quadric q = quadrics_[u];
  q.add(quadrics_[v]);
  const Vec3 a = mesh_.point_mm(u), b = mesh_.point_mm(v), middle = (a + b) / 2;
  const auto snapped = [this](Vec3 p) {
    return Vec3{std::nearbyint(p.x / step_) * step_, std::nearbyint(p.y / step_) * step_,
                std::nearbyint(p.z / step_) * step_};
  };
  Vec3 best;
  if (q.minimum(best) && norm(best - middle) <= 1.5 * norm(b - a)) {
    best = snapped(best);
    cost = q.at(best);
    return best;
  }
  cost = std::numeric_limits<double>::infinity();
  for (const Vec3 p : {snapped(middle), a, b})
    if (q.at(p) < cost) {
      cost = q.at(p);
      best = p;
    }
  return best;
}

bool EdgeCollapse::candidate(std::uint32_t half_edge, Candidate& c) const {
  const std::uint32_t u = mesh_.from(half_edge), v = mesh_.to(half_edge);
  if (locked_[u] || locked_[v]) return false;
  double cost = 0;
  place(u, v, cost);
  c = {static_cast<float>(std::max(cost, 0.0)), half_edge, versions_[u] + versions_[v]};
  return true;
}

bool EdgeCollapse::keeps_shape(std::uint32_t u, std::uint32_t v, Vec3 at) {
  staying_.clear();
  corners_.clear();
  double worst_before = 1, worst_after = 1;
  bool good = true;
  const auto look = [&](std::uint32_t moving, std::uint32_t other) {
    mesh_.for_each_leaving(moving, [&](std::uint32_t e) {
      if (!good) return;
      const std::uint32_t across = CollapseMesh::next(e);
      const std::uint32_t p = mesh_.to(e), q = mesh_.to(across);
      const Vec3 old = mesh_.point_mm(moving), b = mesh_.point_mm(p), c = mesh_.point_mm(q);
      const double before = compactness(old, b, c);
      worst_before = std::min(worst_before, before);
      if (p == other || q == other) return;
      const Vec3 n0 = cross(b - old, c - old), n1 = cross(b - at, c - at);
      const double lengths = norm(n0) * norm(n1);
      // A sliver's normal says little: it need only not turn over.
      if (!(dot(n0, n1) > (before > least_compactness ? least_turn_cosine : 0) * lengths) || !(lengths > 0)) {
        good = false;
        return;
      }
      const auto& far = mesh_.triangle(mesh_.twin(across) / 3);
      const Vec3 o = mesh_.point_mm(far[0]);
      const Vec3 n2 = cross(mesh_.point_mm(far[1]) - o, mesh_.point_mm(far[2]) - o);
      const bool is_outer = std::find(far.begin(), far.end(), other) == far.end();
      if (is_outer && dot(n1, n2) < least_fold_cosine * norm(n1) * norm(n2) &&
          dot(n1, n2) * norm(n0) < dot(n0, n2) * norm(n1)) {
        good = false;
        return;
      }
      worst_after = std::min(worst_after, compactness(at, b, c));
      staying_.push_back(e / 3);
      corners_.push_back({at, b, c});
    });
  };
  look(u, v);
  look(v, u);
  return good && worst_after >= std::min(least_compactness, worst_before);
}

/// Looks at the triangles that are coarse beside the input, where a carried point has come some way: where none has, no
/// triangle lies far from the input either (it happens, seldom; the final measurement sees to that).
bool EdgeCollapse::samples_within() {
  if (carried_.farthest() < some_way * some_way * squared_limit_) return true;
  const double coarse = 2 * meter_.mean_edge_mm();
  for (std::size_t n = 0; n < corners_.size(); ++n) {
    const auto& [at, b, c] = corners_[n];
    if (dot(b - at, b - at) < coarse * coarse && dot(c - at, c - at) < coarse * coarse) continue;
    if (!meter_.within(corners_[n], near_[staying_[n]])) return false;
  }
  return true;
}

EdgeCollapse::Outcome EdgeCollapse::attempt(std::uint32_t h) {
  if (!mesh_.keeps_manifold(h)) return Outcome::shape;
  const std::uint32_t u = mesh_.from(h), v = mesh_.to(h);
  double cost = 0;
  const Vec3 at = place(u, v, cost);
  if (!keeps_shape(u, v, at)) return Outcome::shape;
  carried_.gather(mesh_, u, v);
  if (!carried_.assign(corners_, squared_limit_) || !samples_within()) return Outcome::limit;
  carried_.commit(mesh_, u, v, staying_);
  mesh_.collapse(h, at);
  quadrics_[u].add(quadrics_[v]);
  versions_[u] = std::max(versions_[u], versions_[v]) + 1;
  return Outcome::done;
}

/// Returns whether it got on; `limited` is set where the limit kept an edge from collapsing.
bool EdgeCollapse::sweep(std::size_t floor, bool& limited) {
  std::vector<std::uint32_t> edges;
  for (std::uint32_t h = 0; h < 3 * mesh_.triangles(); ++h)
    if (mesh_.live_triangle(h / 3) && h < mesh_.twin(h)) edges.push_back(h);
  const float none = std::numeric_limits<float>::infinity();
  std::vector<float> costs(edges.size(), none);
  parallel_for(0, static_cast<std::int64_t>(edges.size()), 8192, [&](std::int64_t from, std::int64_t to) {
    for (std::int64_t n = from; n < to; ++n) {
      Candidate c;
      if (candidate(edges[n], c)) costs[n] = c.cost;
    }
  });
  std::vector<float> sorted = costs;
  const auto cut = sorted.begin() + static_cast<std::ptrdiff_t>(cheap_share * static_cast<double>(sorted.size()));
  std::nth_element(sorted.begin(), cut, sorted.end());
  const float threshold = *cut;

  const std::size_t before = mesh_.live_triangles();
  std::vector<char> touched(mesh_.points(), 0);
  for (std::size_t n = 0; n < edges.size() && mesh_.live_triangles() > floor; ++n) {
    const std::uint32_t h = edges[n];
    if (!(costs[n] <= threshold) || costs[n] == none || !mesh_.live_triangle(h / 3)) continue;
    const std::uint32_t u = mesh_.from(h), v = mesh_.to(h);
    if (touched[u] || touched[v]) continue;
    const Outcome outcome = attempt(h);
    limited |= outcome == Outcome::limit;
    if (outcome != Outcome::done) continue;
    touched[u] = 1;
    mesh_.for_each_leaving(u, [&](std::uint32_t e) { touched[mesh_.to(e)] = 1; });
  }
  return before - mesh_.live_triangles() > before / 50;
}

bool EdgeCollapse::run(std::size_t target, const Progress& progress) {
  Candidate c;
  const std::size_t start = mesh_.live_triangles();
  bool limited = false;
  const auto report = [&] {
    const auto gone = static_cast<double>(start - mesh_.live_triangles());
    progress.report(gone / static_cast<double>(std::max<std::size_t>(1, start - std::min(start, target))));
  };
  const auto floor = std::max<std::size_t>({static_cast<std::size_t>(swept_to_target * static_cast<double>(target)),
                                            mesh_.triangles() / swept_to_share, swept_to_count});
  while (mesh_.live_triangles() > floor && sweep(floor, limited)) report();

  heap_.clear();
  for (std::uint32_t h = 0; h < 3 * mesh_.triangles(); ++h)
    if (mesh_.live_triangle(h / 3) && h < mesh_.twin(h) && candidate(h, c)) heap_.push_back(c);
  std::make_heap(heap_.begin(), heap_.end(), Later());
  for (std::size_t steps = 0; mesh_.live_triangles() > target && !heap_.empty(); ++steps) {
    if (steps % 4096 == 0) report();
    std::pop_heap(heap_.begin(), heap_.end(), Later());
    c = heap_.back();
    heap_.pop_back();
    const std::uint32_t h = c.half_edge;
    if (!mesh_.live_triangle(h / 3) || versions_[mesh_.from(h)] + versions_[mesh_.to(h)] != c.version) continue;
    const std::uint32_t u = mesh_.from(h);
    const Outcome outcome = attempt(h);
    limited |= outcome == Outcome::limit;
    if (outcome != Outcome::done) continue;
    mesh_.for_each_leaving(u, [&](std::uint32_t e) {
      if (!candidate(e, c)) return;
      heap_.push_back(c);
      std::push_heap(heap_.begin(), heap_.end(), Later());
    });
  }
  return limited;
}

std::size_t EdgeCollapse::undo(const std::vector<std::uint32_t>& triangles) {
  std::size_t count = 0;
  for (std::vector<std::uint32_t> at = triangles; !at.empty() && count == 0; at = widened(at))
    for (const std::uint32_t t : at) count += undo_at(t);
  return count;
}

/// With the triangles around the corners of these; none where that adds nothing.
std::vector<std::uint32_t> EdgeCollapse::widened(const std::vector<std::uint32_t>& triangles) const {
  std::vector<std::uint32_t> more = triangles;
  for (const std::uint32_t t : triangles)
    if (mesh_.live_triangle(t))
      for (const std::uint32_t v : mesh_.triangle(t))
        mesh_.for_each_leaving(v, [&](std::uint32_t e) { more.push_back(e / 3); });
  std::sort(more.begin(), more.end());
  more.erase(std::unique(more.begin(), more.end()), more.end());
  if (more.size() <= triangles.size()) more.clear();
  return more;
}

std::size_t EdgeCollapse::undo_at(std::uint32_t t) {
  std::size_t count = 0;
  const std::uint32_t collapse = mesh_.live_triangle(t) ? mesh_.last_change(t) : CollapseMesh::none;
  if (collapse == CollapseMesh::none) return 0;
  mesh_.undo(collapse, [&](std::uint32_t u, std::uint32_t v) {
    ++count;
    locked_[u] = locked_[v] = 1;
    staying_.clear();
    corners_.clear();
    const auto take = [&](std::uint32_t triangle) {
      const auto& p = mesh_.triangle(triangle);
      staying_.push_back(triangle);
      corners_.push_back({mesh_.point_mm(p[0]), mesh_.point_mm(p[1]), mesh_.point_mm(p[2])});
    };
    mesh_.for_each_leaving(u, [&](std::uint32_t e) { take(e / 3); });
    mesh_.for_each_leaving(v, [&](std::uint32_t e) {
      if (mesh_.to(e) != u && mesh_.to(CollapseMesh::next(e)) != u) take(e / 3);
    });
    carried_.gather(mesh_, u, v);
    carried_.assign(corners_, std::numeric_limits<double>::infinity());
    carried_.commit(mesh_, u, v, staying_);
  });
  return count;
}

}  // namespace trephine
