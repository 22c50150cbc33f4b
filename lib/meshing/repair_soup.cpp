// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/repair_soup.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include "base/disjoint_sets.h"
#include "meshing/repair_winding.h"
#include "meshing/validity.h"
#include "surface/incidence.h"

namespace trephine::meshing {
namespace {

using Triangle = std::array<std::uint32_t, 3>;
constexpr std::uint32_t none = 0xffffffffu;

bool sideless(const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }

std::size_t drop_sideless(surface::TriMesh& mesh) {
  const std::size_t before = mesh.triangles.size();
  mesh.triangles.erase(std::remove_if(mesh.triangles.begin(), mesh.triangles.end(), sideless), mesh.triangles.end());
  return before - mesh.triangles.size();
}

void drop_marked(surface::TriMesh& mesh, const std::vector<char>& drop) {
  std::size_t kept = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    if (!drop[t]) mesh.triangles[kept++] = mesh.triangles[t];
  mesh.triangles.resize(kept);
}

std::size_t merge_equal(surface::TriMesh& mesh) {
  std::vector<std::uint32_t> order(mesh.points_mm.size()), kept(order.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto key = [&](std::uint32_t i) {
    const Vec3 p = mesh.points_mm[i];
    return std::array<double, 3>{p.x, p.y, p.z};
  };
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
  std::size_t merged = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && key(order[i]) == key(order[i - 1]);
    kept[order[i]] = same ? kept[order[i - 1]] : order[i];
    merged += same;
  }
  for (auto& t : mesh.triangles)
    for (std::uint32_t& v : t) v = kept[v];
  return merged;
}

/// Joins points of edges that only one triangle uses; they are found by a sweep along x.
std::size_t merge_open(surface::TriMesh& mesh, double merge_mm, const Progress& progress) {
  std::vector<char> open(mesh.points_mm.size(), 0);
  double length = 0;
  std::size_t edges = 0;
  surface::for_each_edge(mesh, surface::Incidence(mesh), [&](std::uint32_t p, auto from, auto to) {
    length += norm(mesh.points_mm[p] - mesh.points_mm[from->other]);
    ++edges;
    if (to - from == 1) open[p] = open[from->other] = 1;
  });
  const double reach = edges > 0 ? std::min(merge_mm, 1e-3 * length / double(edges)) : 0;
  if (!(reach > 0)) return 0;
  std::vector<std::uint32_t> order;
  for (std::uint32_t i = 0; i < open.size(); ++i)
    if (open[i]) order.push_back(i);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return mesh.points_mm[a].x < mesh.points_mm[b].x; });
  DisjointSets sets(mesh.points_mm.size());
  std::size_t merged = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    progress.check();  // points of one x are a quadratic number of pairs
    for (std::size_t j = i + 1; j < order.size(); ++j) {
      const Vec3 d = mesh.points_mm[order[j]] - mesh.points_mm[order[i]];
      if (d.x > reach) break;
      if (norm(d) > reach || sets.find(order[i]) == sets.find(order[j])) continue;
      sets.unite(order[i], order[j]);
      ++merged;
    }
  }
  for (auto& t : mesh.triangles)
    for (std::uint32_t& v : t) v = sets.find(v);
  return merged;
}

std::size_t drop_duplicates(surface::TriMesh& mesh) {
  const std::size_t n = mesh.triangles.size();
  std::vector<std::uint32_t> order(n);
  std::iota(order.begin(), order.end(), 0u);
  const auto key = [&](std::uint32_t t) {
    Triangle k = mesh.triangles[t];
    std::sort(k.begin(), k.end());
    return k;
  };
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
  std::vector<char> drop(n, 0), several(n, 0);
  for (std::size_t i = 1; i < n; ++i)
    if (key(order[i]) == key(order[i - 1])) {
      drop[order[i]] = 1;
      several[order[i]] = several[order[i - 1]] = 1;
    }
  const std::size_t extra = std::size_t(std::count(drop.begin(), drop.end(), 1));
  if (extra == 0) return 0;
  // The triangle is an inner wall: on each of its edges two other triangles meet.
  std::vector<std::uint8_t> held(n, 0);
  surface::for_each_edge(mesh, surface::Incidence(mesh), [&](std::uint32_t, auto from, auto to) {
    int others = 0;
    for (auto u = from; u != to; ++u) others += !several[u->triangle];
    for (auto u = from; u != to; ++u)
      if (!drop[u->triangle] && others >= 2) ++held[u->triangle];
  });
  for (std::size_t t = 0; t < n; ++t)
    if (several[t] && !drop[t] && held[t] == 3) drop[t] = 1;
  drop_marked(mesh, drop);
  return n - mesh.triangles.size();
}

std::size_t drop_fins(surface::TriMesh& mesh) {
  std::size_t dropped = 0;
  for (;;) {
    std::vector<char> free(mesh.triangles.size(), 0), crowded(mesh.triangles.size(), 0);
    surface::for_each_edge(mesh, surface::Incidence(mesh), [&](std::uint32_t, auto from, auto to) {
      for (auto u = from; u != to; ++u) {
        if (to - from == 1) free[u->triangle] = 1;
        if (to - from > 2) crowded[u->triangle] = 1;
      }
    });
    std::size_t now = 0;
    for (std::size_t t = 0; t < free.size(); ++t) now += free[t] = free[t] && crowded[t];
    if (now == 0) return dropped;
    drop_marked(mesh, free);
    dropped += now;
  }
}

/// twin[3 t + c] of the half-edge from corner c of triangle t, or none.
struct HalfEdges {
  std::vector<std::uint32_t> twin;
};

std::uint32_t half_edge(const surface::TriMesh& mesh, std::uint32_t t, std::uint32_t from, std::uint32_t to) {
  const Triangle& v = mesh.triangles[t];
  for (std::uint32_t c = 0; c < 3; ++c)
    if (v[c] == from && v[(c + 1) % 3] == to) return 3 * t + c;
  return none;
}

/// Orients the triangles of each patch alike. Returns how many were turned.
std::size_t orient(surface::TriMesh& mesh) {
  struct Link {
    std::uint32_t triangle;
    bool same;  ///< both look to the same side
  };
  std::vector<std::vector<Link>> links(mesh.triangles.size());
  surface::for_each_edge(mesh, surface::Incidence(mesh), [&](std::uint32_t, auto from, auto to) {
    if (to - from != 2) return;
    const surface::EdgeUse &a = *from, &b = *(from + 1);
    links[a.triangle].push_back({b.triangle, a.forward != b.forward});
    links[b.triangle].push_back({a.triangle, a.forward != b.forward});
  });
  std::vector<signed char> side(mesh.triangles.size(), 0);
  std::vector<std::uint32_t> patch;
  std::size_t flipped = 0;
  for (std::uint32_t start = 0; start < mesh.triangles.size(); ++start) {
    if (side[start]) continue;
    patch.assign(1, start);
    side[start] = 1;
    double area[2] = {0, 0};
    for (std::size_t i = 0; i < patch.size(); ++i) {
      const std::uint32_t t = patch[i];
      area[side[t] > 0] += norm(surface::triangle_normal(mesh, t));
      for (const Link& l : links[t])
        if (!side[l.triangle]) {
          side[l.triangle] = static_cast<signed char>(l.same ? side[t] : -side[t]);
          patch.push_back(l.triangle);
        }
    }
    const signed char wrong = area[1] >= area[0] ? -1 : 1;
    for (const std::uint32_t t : patch)
      if (side[t] == wrong) {
        std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
        ++flipped;
      }
  }
  return flipped;
}

/// Around an edge from a to b: pairs those uses between which the solid lies, where forward and backward alternate.
void pair_around(const surface::TriMesh& mesh, std::uint32_t a, const std::vector<surface::EdgeUse>& uses,
                 HalfEdges& edges) {
  const std::uint32_t b = uses[0].other;
  const Vec3 axis = normalized(mesh.points_mm[b] - mesh.points_mm[a]);
  const Vec3 x = normalized(std::abs(axis.x) < 0.6 ? cross(axis, Vec3{1, 0, 0}) : cross(axis, Vec3{0, 1, 0}));
  const Vec3 y = cross(axis, x);
  std::vector<std::pair<double, std::size_t>> turn;
  for (std::size_t i = 0; i < uses.size(); ++i) {
    const Triangle& t = mesh.triangles[uses[i].triangle];
    Vec3 apex;
    for (const std::uint32_t v : t)
      if (v != a && v != b) apex = mesh.points_mm[v] - mesh.points_mm[a];
    turn.emplace_back(std::atan2(dot(apex, y), dot(apex, x)), i);
  }
  std::sort(turn.begin(), turn.end());
  const std::size_t n = turn.size();
  for (std::size_t i = 0; i < n; ++i)
    if (uses[turn[i].second].forward == uses[turn[(i + 1) % n].second].forward || n % 2 != 0 ||
        turn[i].first == turn[(i + 1) % n].first)
      return;
  // A forward triangle's normal points along the turn; so the solid lies before it, down to a backward one.
  for (std::size_t i = 0; i < n; ++i) {
    const surface::EdgeUse &u = uses[turn[i].second], &before = uses[turn[(i + n - 1) % n].second];
    if (!u.forward) continue;
    const std::uint32_t h = half_edge(mesh, u.triangle, a, b), g = half_edge(mesh, before.triangle, b, a);
    edges.twin[h] = g;
    edges.twin[g] = h;
  }
}

HalfEdges join(const surface::TriMesh& mesh) {
  HalfEdges edges;
  edges.twin.assign(3 * mesh.triangles.size(), none);
  surface::for_each_edge(mesh, surface::Incidence(mesh), [&](std::uint32_t p, auto from, auto to) {
    if (to - from == 2 && from->forward != (from + 1)->forward) {
      const surface::EdgeUse &f = from->forward ? *from : *(from + 1), &g = from->forward ? *(from + 1) : *from;
      const std::uint32_t h = half_edge(mesh, f.triangle, p, f.other), k = half_edge(mesh, g.triangle, f.other, p);
      edges.twin[h] = k;
      edges.twin[k] = h;
    } else if (to - from > 2) {
      pair_around(mesh, p, std::vector<surface::EdgeUse>(from, to), edges);
    }
  });
  return edges;
}

/// Gives each fan of triangles a point of its own. Copies that lie on no border are moved inwards, so that the fans do
/// not touch. Returns how many points were added.
std::size_t split_points(surface::TriMesh& mesh, const HalfEdges& edges, double step) {
  const std::size_t corners = 3 * mesh.triangles.size();
  DisjointSets fans(corners);
  std::vector<char> at_border(corners, 0);
  for (std::uint32_t h = 0; h < corners; ++h) {
    const std::uint32_t next = h % 3 == 2 ? h - 2 : h + 1;
    if (const std::uint32_t g = edges.twin[h]; g != none) {
      fans.unite(h, g % 3 == 2 ? g - 2 : g + 1);
      fans.unite(next, g);
    } else {
      at_border[h] = at_border[next] = 1;
    }
  }
  for (std::uint32_t h = 0; h < corners; ++h)
    if (at_border[h]) at_border[fans.find(h)] = 1;
  const std::size_t before = mesh.points_mm.size();
  std::vector<std::uint32_t> first(before, none), point_of(corners, none), origin;
  std::vector<char> several(before, 0), border;
  std::vector<Vec3> points, normals;
  for (std::uint32_t h = 0; h < corners; ++h) {
    const std::uint32_t fan = fans.find(h), v = mesh.triangles[h / 3][h % 3];
    if (point_of[fan] == none) {
      point_of[fan] = static_cast<std::uint32_t>(points.size());
      points.push_back(mesh.points_mm[v]);
      normals.push_back({});
      origin.push_back(v);
      border.push_back(at_border[fan]);
      if (first[v] == none)
        first[v] = point_of[fan];
      else
        several[v] = 1;
    }
    normals[point_of[fan]] += normalized(surface::triangle_normal(mesh, h / 3));
  }
  std::size_t used = 0, split = 0;
  for (const std::uint32_t f : first) used += f != none;
  split = points.size() - used;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (several[origin[i]] && !border[i]) points[i] = points[i] - normalized(normals[i]) * (6 * step);
  for (std::uint32_t h = 0; h < corners; ++h) mesh.triangles[h / 3][h % 3] = point_of[fans.find(h)];
  mesh.points_mm = std::move(points);
  return split;
}

/// Drops flat open pieces, and orients closed pieces that lie in no other one outwards.
void settle_components(surface::TriMesh& mesh, SoupCounts& counts, const Progress& progress) {
  std::vector<int> label;
  const int n = surface::label_components(mesh, label);
  std::vector<char> open(n, 0), drop(n, 0), turn(n, 0);
  std::vector<Vec3> rim(n);
  std::vector<std::size_t> rim_points(n, 0);
  surface::for_each_edge(mesh, surface::Incidence(mesh), [&](std::uint32_t p, auto from, auto to) {
    if (to - from != 1) return;
    const int c = label[from->triangle];
    open[c] = 1;
    rim[c] += mesh.points_mm[p] + mesh.points_mm[from->other];
    rim_points[c] += 2;
  });
  std::vector<double> area(n, 0), volume(n, 0);
  std::vector<std::uint32_t> sample(n, none);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const int c = label[t];
    const Vec3 o = rim_points[c] ? rim[c] / double(rim_points[c]) : mesh.points_mm[mesh.triangles[0][0]];
    const Vec3 a = mesh.points_mm[mesh.triangles[t][0]] - o, b = mesh.points_mm[mesh.triangles[t][1]] - o,
               d = mesh.points_mm[mesh.triangles[t][2]] - o;
    area[c] += norm(cross(b - a, d - a)) / 2;
    volume[c] += dot(a, cross(b, d)) / 6;
    if (sample[c] == none) sample[c] = t;
  }
  for (int c = 0; c < n; ++c) {
    drop[c] = (open[c] && std::abs(volume[c]) <= 2e-3 * std::pow(area[c], 1.5)) || !(area[c] > 0);
    counts.sheets += drop[c];
  }
  std::vector<surface::TriMesh> parts;
  for (int c = 0; c < n; ++c) {
    if (drop[c] || volume[c] >= 0) continue;
    progress.check();
    // The piece lies in no other one: the winding number of the others is about 0 there, however they are oriented.
    surface::TriMesh others;
    others.points_mm = mesh.points_mm;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      if (label[t] != c && !drop[label[t]]) others.triangles.push_back(mesh.triangles[t]);
    const Vec3 at = mesh.points_mm[mesh.triangles[sample[c]][0]];
    turn[c] = others.triangles.empty() || std::abs(winding_number(others, at)) < 0.5;
  }
  std::vector<char> gone(mesh.triangles.size(), 0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    gone[t] = drop[label[t]];
    if (turn[label[t]]) {
      std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
      ++counts.flipped;
    }
  }
  drop_marked(mesh, gone);
}

}  // namespace

void clean_soup(surface::TriMesh& mesh, double merge_mm, SoupCounts& counts, const Progress& progress) {
  mesh.normals.clear();
  snap_to_float32(mesh);
  counts.merged = merge_equal(mesh) + merge_open(mesh, merge_mm, progress);
  counts.sideless = drop_sideless(mesh);
  progress.report(0.2);
  counts.duplicates = drop_duplicates(mesh);
  counts.fins = drop_fins(mesh);
  progress.report(0.4);
  counts.flipped = orient(mesh);
  const HalfEdges edges = join(mesh);
  counts.split = split_points(mesh, edges, float32_step_mm(mesh));
  progress.report(0.6);
  settle_components(mesh, counts, progress);
  surface::drop_unused_points(mesh);
  progress.report(1);
}

}  // namespace trephine::meshing
