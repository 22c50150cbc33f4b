// SPDX-License-Identifier: GPL-3.0-or-later
// Groups of neighbouring triangles are tested against the triangles in their bounding box, those of marching cubes
// against the cells beside their own. Most pairs whose boxes meet share a point. Such pairs are ruled out together, one
// point at a time, where the triangles around the point project to one plane as a fan.
#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "meshing/exact.h"
#include "meshing/validity.h"
#include "surface/cell_rows.h"
#include "surface/fan.h"
#include "surface/incidence.h"
#include "surface/triangle_tree.h"

namespace trephine::meshing {
namespace {

constexpr std::size_t group_leaves = 4, group_size = group_leaves * surface::TriangleTree::width;

std::array<Vec3, 3> corners_of(const surface::TriMesh& m, std::uint32_t t) {
  const auto& v = m.triangles[t];
  return {m.points_mm[v[0]], m.points_mm[v[1]], m.points_mm[v[2]]};
}

/// For each triangle: 2 where it is degenerate, 1 where each of its points has a fan, else 0. Without the incidence,
/// fans are not looked for.
std::vector<char> classify(const surface::TriMesh& mesh, const surface::Incidence* incidence) {
  std::vector<char> fan(mesh.points_mm.size()), kind(mesh.triangles.size());
  parallel_for(0, static_cast<std::int64_t>(incidence ? fan.size() : 0), 8192, [&](std::int64_t from, std::int64_t to) {
    for (std::int64_t p = from; p < to; ++p) fan[p] = surface::is_fan(mesh, *incidence, static_cast<std::uint32_t>(p));
  });
  parallel_for(0, static_cast<std::int64_t>(kind.size()), 16384, [&](std::int64_t from, std::int64_t to) {
    for (std::int64_t t = from; t < to; ++t) {
      const auto& v = mesh.triangles[t];
      const auto p = corners_of(mesh, static_cast<std::uint32_t>(t));
      kind[t] = on_a_line(p[0], p[1], p[2]) ? 2 : fan[v[0]] && fan[v[1]] && fan[v[2]];
    }
  });
  return kind;
}

bool share(const std::array<std::uint32_t, 3>& a, const std::array<std::uint32_t, 3>& b) {
  int n = 0;
  for (const std::uint32_t i : a)
    for (const std::uint32_t j : b) n |= i == j;
  return n != 0;
}

/// Of one chunk of the work: a tangle of millions of crossings is not worth its memory, and some are enough to refuse
/// it.
constexpr std::size_t max_pairs = std::size_t{1} << 20;

/// Boxes of triangles, coordinate by coordinate.
struct Boxes {
  std::array<std::vector<float>, 3> min, max;
  std::vector<std::uint32_t> number;  ///< in the tree's order
  std::vector<std::int32_t> hit;
  std::vector<std::uint32_t> met;  ///< the first met_count: which of them meet
  std::size_t met_count = 0;
  void clear() {
    for (int a = 0; a < 3; ++a) min[a].clear(), max[a].clear();
    number.clear();
  }
  void add(const surface::FloatBox& box, std::uint32_t n) {
    for (int a = 0; a < 3; ++a) min[a].push_back(box.min[a]), max[a].push_back(box.max[a]);
    number.push_back(n);
  }
  /// Finds those from `first` on that meet this box.
  void meet(const surface::FloatBox& b, std::size_t first) {
    if (hit.size() < number.size()) {
      hit.resize(number.size());
      met.resize(number.size());
    }
    const float *x0 = min[0].data(), *y0 = min[1].data(), *z0 = min[2].data();
    const float *x1 = max[0].data(), *y1 = max[1].data(), *z1 = max[2].data();
    const float bx0 = b.min[0], by0 = b.min[1], bz0 = b.min[2], bx1 = b.max[0], by1 = b.max[1], bz1 = b.max[2];
    std::int32_t* h = hit.data();
    const std::size_t count = number.size();
    for (std::size_t n = first; n < count; ++n)
      h[n] = (x0[n] <= bx1) & (bx0 <= x1[n]) & (y0[n] <= by1) & (by0 <= y1[n]) & (z0[n] <= bz1) & (bz0 <= z1[n]);
    met_count = 0;
    for (std::size_t n = first; n < count; ++n) {
      met[met_count] = number[n];
      met_count += static_cast<std::size_t>(h[n]);
    }
  }
};

/// Marks with 2, as degenerate ones, all but the first of triangles with the same corners, and pairs each with it: what
/// meets the first meets all of them, and all pairs of n equal triangles would be n^2. Equal ones have equal boxes and
/// stand together in the tree's order.
std::vector<std::array<std::uint32_t, 2>> set_equal_aside(const surface::TriMesh& mesh,
                                                          const surface::TriangleTree& tree, std::vector<char>& kind) {
  std::vector<std::array<std::uint32_t, 2>> pairs;
  const auto& order = tree.order();
  const auto key = [&](std::uint32_t t) {
    auto c = corners_of(mesh, t);
    const auto less = [](Vec3 a, Vec3 b) { return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z; };
    std::sort(c.begin(), c.end(), less);
    return std::array<double, 9>{c[0].x, c[0].y, c[0].z, c[1].x, c[1].y, c[1].z, c[2].x, c[2].y, c[2].z};
  };
  std::vector<std::pair<std::array<double, 9>, std::uint32_t>> run;
  for (std::size_t from = 0, to = 0; from < order.size(); from = to) {
    const surface::FloatBox& box = tree.box(from);
    while (to < order.size() && tree.box(to).min == box.min && tree.box(to).max == box.max) ++to;
    if (to - from < 2) continue;
    run.clear();
    for (std::size_t n = from; n < to; ++n)
      if (kind[order[n]] != 2) run.emplace_back(key(order[n]), order[n]);
    std::sort(run.begin(), run.end());
    for (std::size_t n = 1, first = 0; n < run.size(); ++n) {
      if (run[n].first != run[first].first) {
        first = n;
        continue;
      }
      pairs.push_back({run[first].second, run[n].second});
      kind[run[n].second] = 2;
    }
  }
  return pairs;
}

using Pairs = std::vector<std::array<std::uint32_t, 2>>;

/// The exact test of a pair, for those that are not known to be apart.
struct PairTest {
  const surface::TriMesh& mesh;
  std::vector<char> kind;
  void operator()(std::uint32_t s, std::uint32_t t, Pairs& out) const {
    if (s == t || ((kind[s] | kind[t]) & 2)) return;
    const auto &a = mesh.triangles[s], &b = mesh.triangles[t];
    if (((kind[s] | kind[t]) & 1) && share(a, b)) return;
    if (triangles_intersect(a, corners_of(mesh, s), b, corners_of(mesh, t)))
      out.push_back({std::min(s, t), std::max(s, t)});
  }
};

Pairs sorted(const std::vector<Pairs>& found, Pairs pairs) {
  for (const auto& f : found) pairs.insert(pairs.end(), f.begin(), f.end());
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

Pairs find_pairs_by_cells(const surface::TriMesh& mesh, const surface::Incidence& incidence,
                          const surface::CellRows& cells, const Progress& progress) {
  const PairTest test{mesh, classify(mesh, &incidence)};
  constexpr std::int64_t grain = 64;
  const auto rows = static_cast<std::int64_t>(cells.rows());
  std::vector<Pairs> found((rows + grain - 1) / grain);
  parallel_for(0, rows, grain, [&](std::int64_t from, std::int64_t to) {
    progress.check();
    for (std::int64_t row = from; row < to; ++row)
      cells.for_each_near_pair(row, [&](std::uint32_t s, std::uint32_t t) { test(s, t, found[from / grain]); });
  });
  return sorted(found, {});
}

Pairs find_pairs(const surface::TriMesh& mesh, const surface::Incidence* incidence, const Progress& progress,
                 const std::vector<std::uint32_t>& only) {
  PairTest test{mesh, classify(mesh, incidence)};
  std::vector<char>& kind = test.kind;
  progress.check();
  const surface::TriangleTree tree(mesh);
  progress.check();
  const auto& order = tree.order();
  const auto equal = set_equal_aside(mesh, tree, kind);
  const auto end_of = [&](std::size_t leaf) {
    return std::min(surface::TriangleTree::width * (leaf + 1), order.size());
  };

  // Tests each triangle that is asked for against all, or each group of leaves against itself and those that follow.
  const std::int64_t grain = only.empty() ? 64 : 512;
  const auto jobs =
      static_cast<std::int64_t>(only.empty() ? (tree.leaves() + group_leaves - 1) / group_leaves : only.size());
  std::vector<Pairs> found((jobs + grain - 1) / grain);
  const auto one = [&](std::uint32_t t, Pairs& out) {
    surface::FloatBox box;
    for (const std::uint32_t v : mesh.triangles[t]) box.add(mesh.points_mm[v]);
    tree.for_each_leaf(box, 0, [&](std::size_t leaf) {
      for (std::size_t n = surface::TriangleTree::width * leaf; n < end_of(leaf); ++n)
        if (box.meets(tree.box(n))) test(t, order[n], out);
    });
  };
  const auto group = [&](std::size_t g, Boxes& boxes, Pairs& out) {
    const std::size_t first = g * group_leaves, begin = g * group_size,
                      end = std::min(begin + group_size, order.size());
    surface::FloatBox box;
    for (std::size_t leaf = first; leaf < std::min(first + group_leaves, tree.leaves()); ++leaf)
      box.add(tree.leaf_box(leaf));
    boxes.clear();
    tree.for_each_leaf(box, first, [&](std::size_t leaf) {
      for (std::size_t n = surface::TriangleTree::width * leaf; n < end_of(leaf); ++n)
        if (kind[order[n]] != 2 && box.meets(tree.box(n))) boxes.add(tree.box(n), static_cast<std::uint32_t>(n));
    });
    std::size_t after = 0;  // their numbers ascend
    for (std::size_t m = begin; m < end && out.size() < max_pairs; ++m) {
      if (kind[order[m]] == 2) continue;
      progress.check();
      while (after < boxes.number.size() && boxes.number[after] <= m) ++after;
      boxes.meet(tree.box(m), after);
      for (std::size_t n = 0; n < boxes.met_count; ++n) test(order[m], order[boxes.met[n]], out);
    }
  };
  parallel_for(0, jobs, grain, [&](std::int64_t from, std::int64_t to) {
    progress.check();
    Boxes boxes;
    for (std::int64_t job = from; job < to; ++job) {
      progress.check();
      if (only.empty())
        group(static_cast<std::size_t>(job), boxes, found[from / grain]);
      else
        one(only[job], found[from / grain]);
    }
  });
  Pairs pairs;
  for (const auto& pair : equal)
    if (only.empty() || std::find(only.begin(), only.end(), pair[0]) != only.end() ||
        std::find(only.begin(), only.end(), pair[1]) != only.end())
      pairs.push_back({std::min(pair[0], pair[1]), std::max(pair[0], pair[1])});
  return sorted(found, std::move(pairs));
}

}  // namespace

std::vector<std::array<std::uint32_t, 2>> self_intersections(const surface::TriMesh& mesh, const Progress& progress,
                                                             const std::vector<std::uint32_t>& only) {
  if (mesh.triangles.empty()) return {};
  // Where there are few pairs, testing them takes less time than looking at the fan of every point.
  if (!only.empty() && only.size() < mesh.triangles.size() / 8) return find_pairs(mesh, nullptr, progress, only);
  return self_intersections(mesh, surface::Incidence(mesh), progress, only);
}

std::vector<std::array<std::uint32_t, 2>> self_intersections(const surface::TriMesh& mesh,
                                                             const surface::Incidence& incidence,
                                                             const Progress& progress,
                                                             const std::vector<std::uint32_t>& only) {
  if (mesh.triangles.empty()) return {};
  return find_pairs(mesh, &incidence, progress, only);
}

std::vector<std::array<std::uint32_t, 2>> self_intersections(const surface::TriMesh& mesh,
                                                             const surface::Incidence& incidence,
                                                             const grid::Lattice& cells, const Progress& progress) {
  if (const auto rows = surface::CellRows::of(mesh, cells))
    return find_pairs_by_cells(mesh, incidence, *rows, progress);
  return self_intersections(mesh, incidence, progress);
}

}  // namespace trephine::meshing
