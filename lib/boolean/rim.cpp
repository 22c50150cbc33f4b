// SPDX-License-Identifier: GPL-3.0-or-later
#include "boolean/rim.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace trephine::boolean {
namespace {

constexpr double sharp_cosine = 0.86;  // 30 degrees
using Triangle = std::array<std::uint32_t, 3>;

struct Edge {
  std::uint32_t low, high, triangle;
  bool operator<(const Edge& o) const {
    return std::array{low, high, triangle} < std::array{o.low, o.high, o.triangle};
  }
};

/// Points on an edge, from its lower point on.
struct Division {
  std::uint32_t low, high;
  int count = 0;
  std::array<std::uint32_t, 2> point{};
};

double quality(Vec3 a, Vec3 b, Vec3 c) {
  const double longest2 = std::max({dot(b - a, b - a), dot(c - b, c - b), dot(a - c, a - c)});
  return longest2 > 0 ? norm(cross(b - a, c - a)) / longest2 : 0;
}

class Rim {
 public:
  Rim(Difference& cut, double step, double width) : d_(cut), m_(cut.mesh), step_(step), width_(width) {}

  void run() {
    find_edges();
    find_sharp();
    divide_edges();
    const auto count = std::uint32_t(m_.triangles.size());
    for (std::uint32_t t = 0; t < count; ++t)
      if (d_.old_triangle[t] == Difference::none) divide(t);
  }

 private:
  Vec3 at(std::uint32_t v) const { return m_.points_mm[v]; }
  Vec3 normal(std::uint32_t t) const { return normalized(surface::triangle_normal(m_, t)); }

  void find_edges() {
    for (std::uint32_t t = 0; t < m_.triangles.size(); ++t)
      if (d_.old_triangle[t] == Difference::none)
        for (int c = 0; c < 3; ++c) {
          const auto [low, high] = std::minmax(m_.triangles[t][c], m_.triangles[t][(c + 1) % 3]);
          edges_.push_back({low, high, t});
        }
    std::sort(edges_.begin(), edges_.end());
  }

  /// Visits the edges between two new triangles.
  template <class F>
  void for_each_edge(const F& f) const {
    for (std::size_t i = 0; i + 1 < edges_.size(); ++i)
      if (edges_[i].low == edges_[i + 1].low && edges_[i].high == edges_[i + 1].high) f(edges_[i], edges_[i + 1]);
  }

  bool sharp(const Edge& e, const Edge& other) const {
    return dot(normal(e.triangle), normal(other.triangle)) < sharp_cosine;
  }

  void find_sharp() {
    on_rim_.resize(m_.points_mm.size());
    for_each_edge([&](const Edge& e, const Edge& other) {
      if (d_.old_point[e.low] != Difference::none || d_.old_point[e.high] != Difference::none) return;
      if (sharp(e, other)) on_rim_[e.low] = on_rim_[e.high] = 1;
    });
  }

  std::uint32_t add_point(std::uint32_t from, std::uint32_t to) {
    const Vec3 along = normalized(at(to) - at(from));
    Vec3 p = at(from) + along * width_;
    for (int a = 0; a < 3; ++a) p[a] = std::nearbyint(p[a] / step_) * step_;
    m_.points_mm.push_back(p);
    d_.old_point.push_back(Difference::none);
    return std::uint32_t(m_.points_mm.size() - 1);
  }

  void divide_edges() {
    for_each_edge([&](const Edge& e, const Edge& other) {
      const bool low = on_rim_[e.low], high = on_rim_[e.high];
      if (!low && !high) return;
      const double length = norm(at(e.high) - at(e.low));
      if (length < (low && high ? 3 : 2) * width_) return;
      if (low && high && sharp(e, other)) return;
      Division n{e.low, e.high};
      if (low) n.point[n.count++] = add_point(e.low, e.high);
      if (high) n.point[n.count++] = add_point(e.high, e.low);
      divisions_.push_back(n);
    });
  }

  const Division* division(std::uint32_t a, std::uint32_t b) const {
    const auto [low, high] = std::minmax(a, b);
    const auto it = std::lower_bound(divisions_.begin(), divisions_.end(), std::array{low, high},
                                     [](const Division& d, const std::array<std::uint32_t, 2>& key) {
                                       return std::array{d.low, d.high} < key;
                                     });
    return it != divisions_.end() && it->low == low && it->high == high ? &*it : nullptr;
  }

  /// The polygon of the triangle's corners and the points on its edges, in the triangles of which the worst is best.
  void divide(std::uint32_t t) {
    std::vector<std::uint32_t> p;
    for (int c = 0; c < 3; ++c) {
      const std::uint32_t a = m_.triangles[t][c], b = m_.triangles[t][(c + 1) % 3];
      p.push_back(a);
      if (const Division* d = division(a, b))
        for (int i = 0; i < d->count; ++i) p.push_back(d->point[a < b ? i : d->count - 1 - i]);
    }
    if (p.size() == 3) return;
    const std::size_t n = p.size();  // at most 9
    double best[9][9];
    std::size_t middle[9][9];
    for (std::size_t span = 1; span < n; ++span)
      for (std::size_t i = 0; i + span < n; ++i) {
        const std::size_t j = i + span;
        best[i][j] = span == 1 ? 1e300 : -1;
        for (std::size_t k = i + 1; k < j; ++k) {
          const double q = std::min({quality(at(p[i]), at(p[k]), at(p[j])), best[i][k], best[k][j]});
          if (q > best[i][j]) {
            best[i][j] = q;
            middle[i][j] = k;
          }
        }
      }
    bool first = true;
    const auto emit = [&](const auto& self, std::size_t i, std::size_t j) -> void {
      if (j - i < 2) return;
      const std::size_t k = middle[i][j];
      const Triangle made{p[i], p[k], p[j]};
      if (first) {
        m_.triangles[t] = made;
        first = false;
      } else {
        m_.triangles.push_back(made);
        d_.old_triangle.push_back(Difference::none);
      }
      self(self, i, k);
      self(self, k, j);
    };
    emit(emit, 0, n - 1);
  }

  Difference& d_;
  surface::TriMesh& m_;
  double step_, width_;
  std::vector<Edge> edges_;
  std::vector<char> on_rim_;
  std::vector<Division> divisions_;
};

}  // namespace

void divide_rim(Difference& cut, double step_mm, double width_mm) { Rim(cut, step_mm, width_mm).run(); }

}  // namespace trephine::boolean
