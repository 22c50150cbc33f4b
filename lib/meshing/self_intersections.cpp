// SPDX-License-Identifier: GPL-3.0-or-later
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/intersections.h>

#include <algorithm>

#include "base/parallel.h"
#include "meshing/exact.h"
#include "meshing/triangle_tree.h"
#include "meshing/validity.h"

namespace trephine {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;

Point exact(Vec3 p) { return {p.x, p.y, p.z}; }

struct Corners {
  std::array<Vec3, 3> p;
  explicit Corners(const TriMesh& m, std::uint32_t t) {
    for (int c = 0; c < 3; ++c) p[c] = m.points_mm[m.triangles[t][c]];
  }
};

/// 1 or -1 where certain, else 0: Shewchuk's first error bound on the determinant.
int quick_side(Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
  const Vec3 u = a - d, v = b - d, w = c - d;
  const double vw = v.x * w.y, wv = w.x * v.y, wu = w.x * u.y, uw = u.x * w.y, uv = u.x * v.y, vu = v.x * u.y;
  const double det = u.z * (vw - wv) + v.z * (wu - uw) + w.z * (uv - vu);
  const double permanent = (std::abs(vw) + std::abs(wv)) * std::abs(u.z) +
                           (std::abs(wu) + std::abs(uw)) * std::abs(v.z) +
                           (std::abs(uv) + std::abs(vu)) * std::abs(w.z);
  const double bound = 8e-16 * permanent;
  return det > bound ? 1 : det < -bound ? -1 : 0;
}

/// All of the points certainly lie strictly on one side of the triangle's plane.
template <std::size_t N>
bool apart(const std::array<Vec3, 3>& t, const std::array<Vec3, N>& points) {
  const int first = quick_side(t[0], t[1], t[2], points[0]);
  if (first == 0) return false;
  for (std::size_t i = 1; i < N; ++i)
    if (quick_side(t[0], t[1], t[2], points[i]) != first) return false;
  return true;
}

Kernel::Triangle_3 exact(const std::array<Vec3, 3>& t) { return {exact(t[0]), exact(t[1]), exact(t[2])}; }

bool overlap_at_edge(Vec3 p, Vec3 q, Vec3 a, Vec3 b) {
  if (quick_side(p, q, a, b) != 0) return false;
  return CGAL::coplanar(exact(p), exact(q), exact(a), exact(b)) &&
         CGAL::coplanar_orientation(exact(p), exact(q), exact(a), exact(b)) == CGAL::POSITIVE;
}

/// The triangles, given with the shared point first, meet beyond it: then one's far side meets the other.
bool meet_beyond_point(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b) {
  if (apart(a, std::array<Vec3, 2>{b[1], b[2]}) || apart(b, std::array<Vec3, 2>{a[1], a[2]})) return false;
  return CGAL::do_intersect(exact(a), Kernel::Segment_3(exact(b[1]), exact(b[2]))) ||
         CGAL::do_intersect(exact(b), Kernel::Segment_3(exact(a[1]), exact(a[2])));
}

}  // namespace

bool on_a_line(Vec3 a, Vec3 b, Vec3 c) {
  const Vec3 n = cross(b - a, c - a);
  const double scale = std::max(dot(b - a, b - a), dot(c - a, c - a));
  if (dot(n, n) > 1e-24 * scale * scale) return false;
  return CGAL::collinear(exact(a), exact(b), exact(c));
}

bool triangles_intersect(const std::array<std::uint32_t, 3>& ia, const std::array<Vec3, 3>& a,
                         const std::array<std::uint32_t, 3>& ib, const std::array<Vec3, 3>& b) {
  int shared = 0, sa[3], sb[3];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (ia[i] == ib[j]) {
        sa[shared] = i;
        sb[shared++] = j;
        break;
      }
  if (shared == 0) {
    if (apart(a, b) || apart(b, a)) return false;
    return CGAL::do_intersect(exact(a), exact(b));
  }
  if (shared == 1)
    return meet_beyond_point({a[sa[0]], a[(sa[0] + 1) % 3], a[(sa[0] + 2) % 3]},
                             {b[sb[0]], b[(sb[0] + 1) % 3], b[(sb[0] + 2) % 3]});
  if (shared == 2) return overlap_at_edge(a[sa[0]], a[sa[1]], a[3 - sa[0] - sa[1]], b[3 - sb[0] - sb[1]]);
  return true;
}

std::vector<std::array<std::uint32_t, 2>> self_intersections(const TriMesh& mesh, const Progress& progress,
                                                             const std::vector<std::uint32_t>& only) {
  if (mesh.triangles.empty()) return {};
  const TriangleTree tree(mesh);
  progress.check();
  const auto flat = [&](std::uint32_t t) {
    const Corners c(mesh, t);
    return on_a_line(c.p[0], c.p[1], c.p[2]);
  };
  std::vector<char> degenerate(mesh.triangles.size());
  parallel_for(0, static_cast<std::int64_t>(mesh.triangles.size()), 16384, [&](std::int64_t from, std::int64_t to) {
    for (std::int64_t t = from; t < to; ++t) degenerate[t] = flat(static_cast<std::uint32_t>(t));
  });

  // Per leaf against the leaves from itself on, or per triangle asked for against all.
  constexpr std::int64_t grain = 512;
  const auto jobs = static_cast<std::int64_t>(only.empty() ? tree.leaves() : only.size());
  std::vector<std::vector<std::array<std::uint32_t, 2>>> found((jobs + grain - 1) / grain);
  const auto& order = tree.order();
  const auto test = [&](std::uint32_t s, std::uint32_t t, auto& out) {
    if (s == t || degenerate[s] || degenerate[t]) return;
    if (triangles_intersect(mesh.triangles[s], Corners(mesh, s).p, mesh.triangles[t], Corners(mesh, t).p))
      out.push_back({std::min(s, t), std::max(s, t)});
  };
  const auto end_of = [&](std::size_t leaf) { return std::min(TriangleTree::width * (leaf + 1), order.size()); };
  parallel_for(0, jobs, grain, [&](std::int64_t from, std::int64_t to) {
    progress.check();
    auto& out = found[from / grain];
    for (std::int64_t job = from; job < to; ++job) {
      if (!only.empty()) {
        FloatBox box;
        for (const std::uint32_t v : mesh.triangles[only[job]]) box.add(mesh.points_mm[v]);
        tree.for_each_leaf(box, 0, [&](std::size_t leaf) {
          for (std::size_t n = TriangleTree::width * leaf; n < end_of(leaf); ++n)
            if (box.meets(tree.box(n))) test(only[job], order[n], out);
        });
        continue;
      }
      const auto own = static_cast<std::size_t>(job);
      tree.for_each_leaf(tree.leaf_box(own), own, [&](std::size_t leaf) {
        for (std::size_t n = TriangleTree::width * leaf; n < end_of(leaf); ++n) {
          if (!tree.box(n).meets(tree.leaf_box(own))) continue;
          for (std::size_t m = TriangleTree::width * own; m < end_of(own); ++m)
            if ((leaf > own || n > m) && tree.box(n).meets(tree.box(m))) test(order[m], order[n], out);
        }
      });
    }
  });
  std::vector<std::array<std::uint32_t, 2>> pairs;
  for (const auto& f : found) pairs.insert(pairs.end(), f.begin(), f.end());
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

}  // namespace trephine
