// SPDX-License-Identifier: GPL-3.0-or-later
// One collapse: where the point goes, what it costs, whether it may; and undoing. The order is in collapse_rounds.cpp.
#include "meshing/edge_collapse.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"

namespace trephine::meshing {
namespace {

/// Weight of the points beside that of the planes: enough to fix a place on a flat part, too little to matter
/// elsewhere.
constexpr double point_weight = 1e-3;
/// A triangle's normal may turn by at most the angle with this cosine, in one collapse.
constexpr double min_turn_cosine = 0.2;
/// Two neighbours may not fold over each other more sharply than this.
constexpr double min_fold_cosine = -0.9;
/// Least compactness (1: equilateral), unless there was a worse triangle before.
constexpr double min_compactness = 0.05;
/// Share of the limit that the carried points may use; the rest is for what lies between them.
constexpr double carried_share = 0.95;
/// Share of the limit that a carried point must be away for the triangles to be sampled.
constexpr double some_way = 0.35;
/// Share of the limit that the root of the mean squared distance to the planes may use while no points are carried.
constexpr double uncarried_share = 0.25;

/// How often collapses that were made without carried points and went too far are undone. The final measurement undoes
/// the rest.
constexpr int times_undone = 20;

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Twice the root of 3, times twice the area, by the sum of the squared sides: 1 for an equilateral triangle.
double compactness(double twice_area, Vec3 a, Vec3 b, Vec3 c) {
  const double squares = dot(b - a, b - a) + dot(c - b, c - b) + dot(a - c, a - c);
  return squares > 0 ? 2 * std::sqrt(3.0) * twice_area / squares : 0;
}

}  // namespace

EdgeCollapse::EdgeCollapse(const surface::TriMesh& input, double limit_mm, double step_mm)
    : plain_input_(input),
      mesh_(input),
      limit2_(limit_mm > 0 ? limit_mm * limit_mm : infinity),
      step_(step_mm),
      carried_(input),
      quadrics_(input.points_mm.size()),
      versions_(input.points_mm.size(), 0),
      costs_(3 * input.triangles.size(), std::numeric_limits<float>::quiet_NaN()),
      flags_(input.points_mm.size(), 0),
      rejected_(input.triangles.size(), 0) {
  area_ = surface::area_mm2(input);
  // The side that all triangles would have if they were equilateral and of one size.
  side_ = std::sqrt(area_ / double(input.triangles.size()) * 4 / std::sqrt(3.0));
  sample_spacing_ = limit_mm > 0 ? 1.4 * std::clamp(1.5 * limit_mm, side_ / 4, side_) : side_;
  std::vector<std::array<float, 4>> planes(input.triangles.size());  // unit normal, and how long the normal was
  parallel_for(0, static_cast<std::int64_t>(planes.size()), 8192, [&](std::int64_t from, std::int64_t to) {
    for (std::int64_t t = from; t < to; ++t) {
      const Vec3 n = surface::triangle_normal(input, t);
      const double length = norm(n);
      planes[t] = {float(n.x / length), float(n.y / length), float(n.z / length), float(length)};
    }
  });
  parallel_for(0, static_cast<std::int64_t>(quadrics_.size()), 8192, [&](std::int64_t from, std::int64_t to) {
    for (auto v = static_cast<std::uint32_t>(from); v < to; ++v) {
      Quadric q;
      mesh_.for_each_leaving(v, [&](std::uint32_t e) {
        const auto& [x, y, z, length] = planes[e / 3];
        q.add_plane({x, y, z}, length / 6);
        q.add_point(length / 6 * point_weight);
      });
      quadrics_[v] = StoredQuadric(q);
    }
  });
}

Vec3 EdgeCollapse::place(std::uint32_t u, std::uint32_t v, double& cost, double& weight) const {
  const Vec3 a = mesh_.point_mm(u), d = mesh_.point_mm(v) - a;
  Quadric q = quadrics_[u].loaded(), r = quadrics_[v].loaded();
  r.shift(-d);
  q.add(r);
  weight = q.weight();
  Vec3 best;
  const double far = dot(d, d) * 1.5 * 1.5;
  if (q.minimum(best) && dot(best - d / 2, best - d / 2) <= far) {
    cost = q.at(best);
    return a + best;
  }
  cost = infinity;
  for (const Vec3 p : {d / 2, Vec3{}, d})
    if (q.at(p) < cost) {
      cost = q.at(p);
      best = p;
    }
  return a + best;
}

bool EdgeCollapse::candidate(std::uint32_t half_edge, Candidate& c) const {
  const std::uint32_t u = mesh_.from(half_edge), v = mesh_.to(half_edge);
  if ((flags_[u] | flags_[v]) & locked) return false;
  double cost = 0, weight = 0;
  place(u, v, cost, weight);
  c = {static_cast<float>(std::max(cost, 0.0)), half_edge, versions_[u] + versions_[v]};
  return true;
}

/// Finds the wings on the way.
bool EdgeCollapse::keeps_manifold(std::uint32_t u, std::uint32_t v, Worker& w) const {
  const auto find = [this](std::uint32_t point, std::vector<Wing>& wings) {
    wings.clear();
    mesh_.for_each_leaving(point, [&](std::uint32_t e) {
      const auto& t = mesh_.triangle(e / 3);
      const std::uint32_t c = e % 3;
      wings.push_back({e, t[c == 2 ? 0 : c + 1], t[c == 0 ? 2 : c - 1]});
    });
  };
  find(u, w.wings_u);
  find(v, w.wings_v);
  int common = 0;
  for (const Wing& a : w.wings_u)
    for (const Wing& b : w.wings_v) common += a.b == b.b;
  // The two ends may share the two points opposite the edge and no other; a tetrahedron would fold flat.
  return common == 2 && !(w.wings_u.size() == 3 && w.wings_v.size() == 3);
}

bool EdgeCollapse::keeps_shape(std::uint32_t u, std::uint32_t v, Vec3 at, Worker& w) const {
  w.staying.clear();
  w.corners.clear();
  double worst_before = 1, worst_after = 1;
  const auto look = [&](const std::vector<Wing>& wings, std::uint32_t moving, std::uint32_t other) {
    const Vec3 old = mesh_.point_mm(moving);
    for (const Wing& wing : wings) {
      const Vec3 b = mesh_.point_mm(wing.b), c = mesh_.point_mm(wing.c);
      const Vec3 n0 = cross(b - old, c - old);
      const double length0 = norm(n0), before = compactness(length0, old, b, c);
      worst_before = std::min(worst_before, before);
      if (wing.b == other || wing.c == other) continue;
      const Vec3 n1 = cross(b - at, c - at);
      const double length1 = norm(n1);
      // The normal of a sliver says little, so it only has to stay on the same side.
      if (!(dot(n0, n1) > (before > min_compactness ? min_turn_cosine : 0) * length0 * length1) ||
          !(length0 * length1 > 0))
        return false;
      const auto& far = mesh_.triangle(mesh_.twin(CollapseMesh::next(wing.half_edge)) / 3);
      if (far[0] != other && far[1] != other && far[2] != other) {
        const Vec3 o = mesh_.point_mm(far[0]);
        const Vec3 n2 = cross(mesh_.point_mm(far[1]) - o, mesh_.point_mm(far[2]) - o);
        const double along = dot(n1, n2);
        if (along < 0 && along < min_fold_cosine * length1 * norm(n2) && along * length0 < dot(n0, n2) * length1)
          return false;
      }
      worst_after = std::min(worst_after, compactness(length1, at, b, c));
      w.staying.push_back(wing.half_edge / 3);
      w.corners.push_back({at, b, c});
    }
    return true;
  };
  return look(w.wings_u, u, v) && look(w.wings_v, v, u) && worst_after >= std::min(min_compactness, worst_before);
}

/// Finds it among the triangles around the nearest of the points that are at hand. `last`: the number of the point that
/// was found for a place beside this one.
bool EdgeCollapse::near_input(Vec3 place, double limit2, const CarriedPoints::Hand& hand, std::size_t& last) const {
  std::uint32_t near = 0;
  if (!hand.points.empty()) {
    bool certainly = false;
    last = hand.places.nearest(place, limit2, certainly, last);
    if (certainly) return true;
    near = hand.points[last];
  }
  return input_->squared_bound(place, near, limit2) <= limit2;
}

/// Measures the new point, and the middles of the new sides and triangles, if a carried point has moved by some
/// distance. If none has, hardly any triangle lies far from the input; the final measurement finds the rare one that
/// does.
bool EdgeCollapse::samples_within(Worker& w) const {
  if (limit2_ == infinity) return true;
  float farthest = 0;
  for (const auto& a : w.hand.assigned) farthest = std::max(farthest, a.second);
  if (farthest < some_way * some_way * limit2_) return true;
  const double limit2 = limit2_ * carried_share * carried_share;
  std::size_t last = 0;
  for (const auto& [at, b, c] : w.corners) {
    // The side to b is another triangle's side to c.
    const Vec3 ab = b - at, ac = c - at;
    const double longest2 = std::max({dot(ab, ab), dot(ac, ac), dot(ac - ab, ac - ab)});
    const int n = static_cast<int>(std::min(std::sqrt(longest2) / sample_spacing_, 30.0)) + 2;
    for (int i = 0; i < n; ++i)
      for (int j = i == 0 ? 0 : 1; j < n - i; ++j)
        if (!near_input(at + ab * (double(i) / n) + ac * (double(j) / n), limit2, w.hand, last)) return false;
  }
  return true;
}

EdgeCollapse::Outcome EdgeCollapse::attempt(std::uint32_t h, Worker& w) {
  const std::uint32_t u = mesh_.from(h), v = mesh_.to(h);
  if (!keeps_manifold(u, v, w)) return Outcome::shape;
  double cost = 0, weight = 0;
  Vec3 at = place(u, v, cost, weight);
  const double rounder = std::ldexp(1.5, 52) * step_;  // adding it rounds to multiples of the step, a power of two
  at = {(at.x + rounder) - rounder, (at.y + rounder) - rounder, (at.z + rounder) - rounder};
  if (!carried_.carries() && cost > limit2_ * uncarried_share * uncarried_share * weight) return Outcome::limit;
  if (!keeps_shape(u, v, at, w)) return Outcome::shape;
  if (carried_.carries()) {
    carried_.gather(mesh_, u, v, w.hand);
    if (!carried_.assign(w.corners, limit2_ * carried_share * carried_share, w.hand)) return Outcome::limit;
    if (limit2_ < infinity && !carried_.between_within(w.corners, input_->incidence(), limit2_, w.hand))
      return Outcome::limit;
    if (!samples_within(w)) return Outcome::limit;
    carried_.commit(mesh_, u, v, w.staying, w.hand);
  }
  Quadric q = quadrics_[u].loaded(), r = quadrics_[v].loaded();
  q.shift(at - mesh_.point_mm(u));
  r.shift(at - mesh_.point_mm(v));
  q.add(r);
  quadrics_[u] = StoredQuadric(q);
  mesh_.collapse(h, at, w.log);
  versions_[u] = std::max(versions_[u], versions_[v]) + 1;
  return Outcome::done;
}

/// Collapses made before points were carried may have left some points too far away. The sooner these collapses are
/// undone, the fewer later ones are undone with them.
void EdgeCollapse::undo_beyond() {
  const double limit2 = limit2_ * carried_share * carried_share;
  std::vector<std::uint32_t> beyond;
  for (int times = 0; times < times_undone; ++times) {
    beyond.clear();
    for (std::uint32_t p = 0; p < plain_input_.points_mm.size(); ++p)
      if (carried_.squared_distance(p) > limit2) beyond.push_back(carried_.carrier(p));
    std::sort(beyond.begin(), beyond.end());
    beyond.erase(std::unique(beyond.begin(), beyond.end()), beyond.end());
    if (beyond.empty() || undo(beyond) == 0) return;
  }
}

std::size_t EdgeCollapse::undo(const std::vector<std::uint32_t>& triangles) {
  std::size_t count = 0;
  for (std::vector<std::uint32_t> at = triangles; !at.empty() && count == 0; at = widened(at))
    for (const std::uint32_t t : at) count += undo_at(t);
  return count;
}

/// These triangles with those around their corners; nothing where that adds no triangle.
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
  Vec3 place;
  std::vector<std::uint32_t> around;
  std::vector<std::array<Vec3, 3>> corners;
  CarriedPoints::Hand hand;
  bool lock = false;
  const auto before = [&](std::uint32_t u, std::uint32_t v) {
    place = mesh_.point_mm(u);
    lock = mesh_.killer(v) == collapse;
  };
  const auto undone = [&](std::uint32_t u, std::uint32_t v) {
    ++count;
    if (lock) flags_[u] |= locked, flags_[v] |= locked;
    Quadric q = quadrics_[u].loaded();
    q.shift(mesh_.point_mm(u) - place);
    quadrics_[u] = StoredQuadric(q);
    around.clear();
    corners.clear();
    const auto take = [&](std::uint32_t triangle) {
      const auto& p = mesh_.triangle(triangle);
      around.push_back(triangle);
      corners.push_back({mesh_.point_mm(p[0]), mesh_.point_mm(p[1]), mesh_.point_mm(p[2])});
      rejected_[triangle] = 0;
      for (std::uint32_t h = 3 * triangle; h < 3 * triangle + 3; ++h)
        costs_[std::min(h, mesh_.twin(h))] = std::numeric_limits<float>::quiet_NaN();
    };
    mesh_.for_each_leaving(u, [&](std::uint32_t e) { take(e / 3); });
    mesh_.for_each_leaving(v, [&](std::uint32_t e) {
      if (mesh_.to(e) != u && mesh_.to(CollapseMesh::next(e)) != u) take(e / 3);
    });
    if (!carried_.carries()) return;
    carried_.gather(mesh_, u, v, hand);
    carried_.assign(corners, infinity, hand);
    carried_.commit(mesh_, u, v, around, hand);
  };
  mesh_.undo(collapse, before, undone);
  return count;
}

}  // namespace trephine::meshing
