// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/carried_points.h"

#include <cmath>
#include <limits>
#include <utility>

#include "base/parallel.h"
#include "surface/triangle_tree.h"

namespace trephine::meshing {
namespace {

constexpr std::uint32_t none = CollapseMesh::none;
/// Where a point has moved by more than this share of the limit, its surroundings are searched too.
constexpr double some_way = 0.5;

/// Calls visit(triangle) for the triangles around u or v, each once.
template <class Visit>
void for_each_around(const CollapseMesh& mesh, std::uint32_t u, std::uint32_t v, Visit&& visit) {
  mesh.for_each_leaving(u, [&](std::uint32_t e) { visit(e / 3); });
  mesh.for_each_leaving(v, [&](std::uint32_t e) {
    const auto& t = mesh.triangle(e / 3);
    if (t[0] != u && t[1] != u && t[2] != u) visit(e / 3);
  });
}

/// The nearest of the triangles around a point. Where the nearest place lies on the rim of these triangles, the search
/// goes on around the rim's point, as long as that leads nearer.
std::uint32_t descend(const CollapseMesh& mesh, std::uint32_t start, Vec3 p, double& best) {
  best = std::numeric_limits<double>::infinity();
  std::uint32_t triangle = none;
  for (std::uint32_t onward = start; onward != none;) {
    const std::uint32_t centre = onward;
    const Vec3 a = mesh.point_mm(centre);
    onward = none;
    mesh.for_each_leaving(centre, [&](std::uint32_t e) {
      const auto& t = mesh.triangle(e / 3);
      const std::uint32_t k = e % 3, b = t[k == 2 ? 0 : k + 1], c = t[k == 0 ? 2 : k - 1];
      int across = 0;
      const double d2 = surface::squared_from_corner(p, a, mesh.point_mm(b), mesh.point_mm(c), across);
      if (!(d2 < best)) return;
      best = d2;
      triangle = e / 3;
      onward = across == 0 ? none : across == 1 ? b : c;
    });
  }
  return triangle;
}

CarriedPoints::Ball ball_around(Vec3 a, Vec3 b, Vec3 c) {
  const Vec3 middle = (a + b + c) / 3;
  const double squared =
      std::max({dot(a - middle, a - middle), dot(b - middle, b - middle), dot(c - middle, c - middle)});
  constexpr double rounding = 1e-6;  // far above that of distances, and of none of the triangles' own size
  return {middle, std::sqrt(squared) * (1 + rounding) + rounding};
}

}  // namespace

void CarriedPoints::take_up(const CollapseMesh& mesh) {
  const std::size_t count = input_.points_mm.size();
  carrier_ = mesh.survivors();
  squared_distance_.resize(count);
  moved_.assign(count, 0);
  parallel_for(0, static_cast<std::int64_t>(count), 8192, [&](std::int64_t from, std::int64_t to) {
    for (std::int64_t p = from; p < to; ++p) {
      double d2 = 0;
      carrier_[p] = descend(mesh, carrier_[p], input_.points_mm[p], d2);
      squared_distance_[p] = static_cast<float>(d2);
    }
  });
  first_.assign(mesh.triangles(), none);
  next_.resize(count);
  for (std::uint32_t p = 0; p < count; ++p) {
    next_[p] = first_[carrier_[p]];
    first_[carrier_[p]] = p;
  }
}

void CarriedPoints::gather(const CollapseMesh& mesh, std::uint32_t u, std::uint32_t v, Hand& hand) const {
  hand.points.clear();
  hand.places.clear();
  for_each_around(mesh, u, v, [&](std::uint32_t t) {
    for (std::uint32_t p = first_[t]; p != none; p = next_[p]) {
      hand.points.push_back(p);
      hand.places.add(input_.points_mm[p]);
    }
  });
}

bool CarriedPoints::assign(const std::vector<std::array<Vec3, 3>>& corners, double squared_limit, Hand& hand) const {
  hand.assigned.clear();
  hand.balls.clear();
  for (const auto& [a, b, c] : corners) hand.balls.push_back(ball_around(a, b, c));
  for (std::size_t i = 0; i < hand.places.size(); ++i) {
    const Vec3 p = hand.places.at(i);
    double best = std::numeric_limits<double>::infinity();
    std::uint32_t where = 0;
    double best_mm = best;
    for (std::uint32_t n = 0; n < corners.size() && best > 0; ++n) {
      // No point of the triangle is nearer than the ball around it.
      const double reach = best_mm + hand.balls[n].radius_mm;
      if (const Vec3 to = p - hand.balls[n].middle; dot(to, to) > reach * reach) continue;
      const Vec3 d = p - surface::closest_on_triangle(p, corners[n][0], corners[n][1], corners[n][2]);
      if (dot(d, d) >= best) continue;
      best = dot(d, d);
      best_mm = std::sqrt(best);
      where = n;
    }
    if (!(best <= squared_limit)) return false;
    hand.assigned.emplace_back(where, static_cast<float>(best));
  }
  return true;
}

bool CarriedPoints::between_within(const std::vector<std::array<Vec3, 3>>& corners, const surface::Incidence& incidence,
                                   double squared_limit, Hand& hand) const {
  constexpr std::uint32_t none_there = 0xffffffffu;
  hand.sorted.clear();
  const auto place_of = [&](std::uint32_t point) {
    if (hand.sorted.empty()) {
      for (std::uint32_t i = 0; i < hand.points.size(); ++i) hand.sorted.emplace_back(hand.points[i], i);
      std::sort(hand.sorted.begin(), hand.sorted.end());
    }
    const auto at = std::lower_bound(hand.sorted.begin(), hand.sorted.end(), std::make_pair(point, 0u));
    return at != hand.sorted.end() && at->first == point ? at->second : none_there;
  };
  const auto squared = [&](Vec3 p, std::uint32_t n) {
    const Vec3 d = p - surface::closest_on_triangle(p, corners[n][0], corners[n][1], corners[n][2]);
    return dot(d, d);
  };
  const auto within = [&](Vec3 p) {
    for (std::uint32_t n = 0; n < corners.size(); ++n)
      if (squared(p, n) <= squared_limit) return true;
    return false;
  };
  for (std::uint32_t i = 0; i < hand.points.size(); ++i) {
    if (hand.assigned[i].second < some_way * some_way * squared_limit) continue;
    const std::uint32_t point = hand.points[i];
    for (std::uint32_t n = incidence.begin[point]; n < incidence.begin[point + 1]; ++n) {
      const auto& t = input_.triangles[incidence.triangle[n]];
      const int k = t[0] == point ? 0 : t[1] == point ? 1 : 2;
      const std::uint32_t next = place_of(t[(k + 1) % 3]);
      if (next == none_there) continue;
      const std::uint32_t own = hand.assigned[i].first, to_next = hand.assigned[next].first;
      const Vec3 p = hand.places.at(i), q = hand.places.at(next);
      // The distance to one triangle is convex.
      if (own != to_next && squared((p + q) / 2, own) > squared_limit && !within((p + q) / 2)) return false;
      const std::uint32_t last = place_of(t[(k + 2) % 3]);
      if (last == none_there || (own == to_next && own == hand.assigned[last].first)) continue;
      const Vec3 middle = (p + q + hand.places.at(last)) / 3;
      if (squared(middle, own) > squared_limit && !within(middle)) return false;
    }
  }
  return true;
}

void CarriedPoints::commit(const CollapseMesh& mesh, std::uint32_t u, std::uint32_t v,
                           const std::vector<std::uint32_t>& triangles, const Hand& hand) {
  for_each_around(mesh, u, v, [&](std::uint32_t t) { first_[t] = none; });
  for (std::size_t n = 0; n < hand.points.size(); ++n) {
    const std::uint32_t point = hand.points[n], t = triangles[hand.assigned[n].first];
    carrier_[point] = t;
    moved_[point] = 1;
    squared_distance_[point] = hand.assigned[n].second;
    next_[point] = first_[t];
    first_[t] = point;
  }
}

}  // namespace trephine::meshing
