// SPDX-License-Identifier: GPL-3.0-or-later
#include "boolean/clean_cut.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace trephine::boolean {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

/// The mesh with the triangles around each point, so that it can be changed in place.
class Patch {
 public:
  Patch(Difference& cut, double shortest, double flattest)
      : d_(cut),
        m_(cut.mesh),
        shortest_(shortest),
        flattest_(flattest),
        around_(m_.points_mm.size()),
        dead_(m_.triangles.size()) {
    for (std::uint32_t t = 0; t < m_.triangles.size(); ++t)
      for (const std::uint32_t v : m_.triangles[t]) around_[v].push_back(t);
  }

  void run() {
    for (int pass = 0; pass < 12; ++pass) {
      bool changed = false;
      for (std::uint32_t v = 0; v < around_.size(); ++v)
        if (d_.old_point[v] == Difference::none) changed |= merge(v);
      for (std::uint32_t t = 0; t < m_.triangles.size(); ++t)
        if (!dead_[t] && d_.old_triangle[t] == Difference::none) changed |= turn(t);
      if (!changed) break;
    }
    compact();
  }

 private:
  Vec3 at(std::uint32_t v) const { return m_.points_mm[v]; }
  static bool has(const Triangle& t, std::uint32_t v) { return t[0] == v || t[1] == v || t[2] == v; }

  std::vector<std::uint32_t> neighbours(std::uint32_t v) const {
    std::vector<std::uint32_t> n;
    for (const std::uint32_t t : around_[v])
      for (const std::uint32_t w : m_.triangles[t])
        if (w != v) n.push_back(w);
    std::sort(n.begin(), n.end());
    n.erase(std::unique(n.begin(), n.end()), n.end());
    return n;
  }

  static double height(Vec3 a, Vec3 b, Vec3 c) {
    const double longest2 = std::max({dot(b - a, b - a), dot(c - b, c - b), dot(a - c, a - c)});
    return longest2 > 0 ? norm(cross(b - a, c - a)) / std::sqrt(longest2) : 0;
  }
  double height(const Triangle& t) const { return height(at(t[0]), at(t[1]), at(t[2])); }
  Vec3 normal(const Triangle& t) const { return cross(at(t[1]) - at(t[0]), at(t[2]) - at(t[0])); }

  /// Its nearest neighbour takes the point, or the next one that can.
  bool merge(std::uint32_t v) {
    if (around_[v].empty()) return false;
    std::vector<std::pair<double, std::uint32_t>> near;
    for (const std::uint32_t w : neighbours(v))
      if (const double l = norm(at(w) - at(v)); l < shortest_) near.emplace_back(l, w);
    std::sort(near.begin(), near.end());
    for (const auto& [length, w] : near)
      if (collapse(v, w)) return true;
    return false;
  }

  bool collapse(std::uint32_t gone, std::uint32_t stays) {
    const auto a = neighbours(gone), b = neighbours(stays);
    std::vector<std::uint32_t> both;
    std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(both));
    if (both.size() != 2 || around_[both[0]].size() < 4 || around_[both[1]].size() < 4) return false;
    for (const std::uint32_t t : around_[gone]) {
      const Triangle was = m_.triangles[t];
      if (has(was, stays)) continue;
      Triangle is = was;
      std::replace(is.begin(), is.end(), gone, stays);
      const double before = height(was), after = height(is);
      if (!(after >= std::min(before, flattest_) && after > 0)) return false;
      const Vec3 n = normal(was), o = normal(is);
      if (before >= flattest_ && !(dot(n, o) > 0.3 * norm(n) * norm(o))) return false;
    }
    for (const std::uint32_t t : around_[gone]) {
      if (has(m_.triangles[t], stays)) {
        dead_[t] = 1;
        for (const std::uint32_t v : m_.triangles[t])
          if (v != gone) remove(v, t);
        continue;
      }
      std::replace(m_.triangles[t].begin(), m_.triangles[t].end(), gone, stays);
      around_[stays].push_back(t);
    }
    around_[gone].clear();
    return true;
  }

  void remove(std::uint32_t v, std::uint32_t t) {
    auto& list = around_[v];
    list.erase(std::find(list.begin(), list.end(), t));
  }

  /// The flat triangle abc, c near ab, and its neighbour bad become adc and dbc.
  bool turn(std::uint32_t t) {
    const Triangle was = m_.triangles[t];
    const double low = height(was);
    if (!(low < flattest_)) return false;
    int longest = 0;
    double most = -1;
    for (int c = 0; c < 3; ++c)
      if (const double l = norm(at(was[(c + 1) % 3]) - at(was[c])); l > most) {
        most = l;
        longest = c;
      }
    const std::uint32_t a = was[longest], b = was[(longest + 1) % 3], c = was[(longest + 2) % 3];
    std::uint32_t other = Difference::none;
    for (const std::uint32_t s : around_[a])
      if (s != t && has(m_.triangles[s], b)) other = s;
    if (other == Difference::none) return false;
    const Triangle next = m_.triangles[other];
    const std::uint32_t d = next[0] != a && next[0] != b ? next[0] : next[1] != a && next[1] != b ? next[1] : next[2];
    if (d == c || around_[a].size() < 4 || around_[b].size() < 4) return false;
    const auto n = neighbours(c);
    if (std::binary_search(n.begin(), n.end(), d)) return false;
    const Triangle first{a, d, c}, second{d, b, c};
    const double beside = height(next);
    if (!(std::min(height(first), height(second)) > std::min(low, beside))) return false;
    const Vec3 up = normal(next);
    if (beside >= flattest_ && !(dot(normal(first), up) > 0 && dot(normal(second), up) > 0)) return false;
    m_.triangles[t] = first;
    m_.triangles[other] = second;
    d_.old_triangle[t] = d_.old_triangle[other] = Difference::none;
    remove(b, t);
    remove(a, other);
    around_[d].push_back(t);
    around_[c].push_back(other);
    return true;
  }

  void compact() {
    std::vector<std::uint32_t> place(m_.points_mm.size(), Difference::none);
    std::uint32_t points = 0, triangles = 0;
    for (std::uint32_t v = 0; v < place.size(); ++v) {
      if (around_[v].empty()) continue;
      place[v] = points;
      m_.points_mm[points] = m_.points_mm[v];
      d_.old_point[points++] = d_.old_point[v];
    }
    for (std::uint32_t t = 0; t < dead_.size(); ++t) {
      if (dead_[t]) continue;
      Triangle moved = m_.triangles[t];
      for (std::uint32_t& v : moved) v = place[v];
      m_.triangles[triangles] = moved;
      d_.old_triangle[triangles++] = d_.old_triangle[t];
    }
    m_.points_mm.resize(points);
    d_.old_point.resize(points);
    m_.triangles.resize(triangles);
    d_.old_triangle.resize(triangles);
  }

  Difference& d_;
  surface::TriMesh& m_;
  double shortest_, flattest_;
  std::vector<std::vector<std::uint32_t>> around_;
  std::vector<char> dead_;
};

}  // namespace

void clean_cut(Difference& cut, double step, double shortest_mm, double flattest_mm) {
  for (std::size_t i = 0; i < cut.mesh.points_mm.size(); ++i) {
    if (cut.old_point[i] != Difference::none) continue;
    Vec3& p = cut.mesh.points_mm[i];
    p = {std::nearbyint(p.x / step) * step, std::nearbyint(p.y / step) * step, std::nearbyint(p.z / step) * step};
  }
  Patch(cut, shortest_mm, flattest_mm).run();
}

}  // namespace trephine::boolean
