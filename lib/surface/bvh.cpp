// SPDX-License-Identifier: GPL-3.0-or-later
// Build: the list of triangles is split in two by the surface area heuristic, the upper levels one after another and
// the subtrees below in parallel. Then pairs of levels are merged into nodes with four children. Query: the nearest
// child first; boxes are stored as float.
#include "surface/bvh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "surface/bounds.h"
#include "surface/float_box.h"

namespace trephine::surface {
namespace {

constexpr std::uint32_t max_leaf = 4;
constexpr int bins = 16;
constexpr int max_sah_depth = 48;  // below it halves by count: at most 32 levels more
constexpr float infinity = std::numeric_limits<float>::infinity();

struct Ref {
  FloatBox box;
  std::uint32_t triangle = 0;
  float centre(int axis) const { return box.min[axis] + box.max[axis]; }  // twice it
};

// A node of the binary tree. A leaf has count > 0 and begins at ref `first`.
struct BinaryNode {
  FloatBox box;
  std::uint32_t left = 0, right = 0, first = 0, count = 0;
};

struct Range {
  std::uint32_t begin, end;
  int depth;
};

// Returns where to split a range: refs before that index go left. For a range that should be a leaf it is the begin.
class Splitter {
 public:
  explicit Splitter(std::vector<Ref>& refs) : refs_(refs) {}

  std::uint32_t split(Range r, FloatBox& box) {
    FloatBox centres;
    for (std::uint32_t i = r.begin; i < r.end; ++i) {
      box.add(refs_[i].box);
      const std::array<float, 3> c{refs_[i].centre(0), refs_[i].centre(1), refs_[i].centre(2)};
      centres.add(c, c);
    }
    const std::uint32_t n = r.end - r.begin;
    if (n <= max_leaf) return r.begin;
    int axis = 0;
    for (int k = 1; k < 3; ++k)
      if (centres.max[k] - centres.min[k] > centres.max[axis] - centres.min[axis]) axis = k;
    const float from = centres.min[axis], extent = centres.max[axis] - from;
    const float scale = float(bins) * 0.9999f / extent;
    if (r.depth >= max_sah_depth || !(extent > 0) || !std::isfinite(scale)) return r.begin + n / 2;
    const auto bin_of = [&](const Ref& ref) { return std::min(bins - 1, int((ref.centre(axis) - from) * scale)); };
    const int cut = best_cut(r, bin_of);
    const auto middle = std::partition(refs_.begin() + r.begin, refs_.begin() + r.end,
                                       [&](const Ref& ref) { return bin_of(ref) < cut; });
    const auto at = std::uint32_t(middle - refs_.begin());
    return at == r.begin || at == r.end ? r.begin + n / 2 : at;
  }

 private:
  template <class BinOf>
  int best_cut(Range r, const BinOf& bin_of) const {
    std::array<FloatBox, bins> box;
    std::array<std::uint32_t, bins> count{};
    for (std::uint32_t i = r.begin; i < r.end; ++i) {
      const int b = bin_of(refs_[i]);
      box[b].add(refs_[i].box);
      ++count[b];
    }
    std::array<float, bins> right_cost{};
    FloatBox right;
    std::uint32_t n = 0;
    for (int b = bins - 1; b > 0; --b) {
      right.add(box[b]);
      n += count[b];
      right_cost[b] = n ? right.half_area() * float(n) : 0;
    }
    FloatBox left;
    n = 0;
    int cut = bins / 2;
    float best = infinity;
    for (int b = 1; b < bins; ++b) {
      left.add(box[b - 1]);
      n += count[b - 1];
      const float cost = (n ? left.half_area() * float(n) : 0) + right_cost[b];
      if (cost < best) best = cost, cut = b;
    }
    return cut;
  }
  std::vector<Ref>& refs_;
};

std::uint32_t build_subtree(Splitter& splitter, Range r, std::vector<BinaryNode>& nodes) {
  const auto at = std::uint32_t(nodes.size());
  nodes.emplace_back();
  FloatBox box;
  const std::uint32_t middle = splitter.split(r, box);
  nodes[at].box = box;
  if (middle == r.begin) {
    nodes[at].first = r.begin;
    nodes[at].count = r.end - r.begin;
  } else {
    const std::uint32_t left = build_subtree(splitter, {r.begin, middle, r.depth + 1}, nodes);
    const std::uint32_t right = build_subtree(splitter, {middle, r.end, r.depth + 1}, nodes);
    nodes[at].left = left;
    nodes[at].right = right;
  }
  return at;
}

std::vector<BinaryNode> build_binary(std::vector<Ref>& refs, const Progress& progress) {
  const auto n = std::uint32_t(refs.size());
  const std::uint32_t piece = std::max<std::uint32_t>(4096, n / 32);
  std::vector<BinaryNode> nodes(1);
  struct Task {
    Range range;
    std::uint32_t node;
  };
  std::vector<Task> upper{{{0, n, 0}, 0}}, tasks;
  Splitter splitter(refs);
  while (!upper.empty()) {
    const Task t = upper.back();
    upper.pop_back();
    if (t.range.end - t.range.begin <= piece) {
      tasks.push_back(t);
      continue;
    }
    progress.check();
    FloatBox box;
    const std::uint32_t middle = splitter.split(t.range, box);
    const auto left = std::uint32_t(nodes.size());
    nodes.resize(nodes.size() + 2);
    nodes[t.node].box = box;
    nodes[t.node].left = left;
    nodes[t.node].right = left + 1;
    upper.push_back({{middle, t.range.end, t.range.depth + 1}, left + 1});
    upper.push_back({{t.range.begin, middle, t.range.depth + 1}, left});
  }
  std::vector<std::vector<BinaryNode>> subtrees(tasks.size());
  parallel_for(0, std::int64_t(tasks.size()), 1, [&](std::int64_t from, std::int64_t to) {
    for (std::int64_t i = from; i < to; ++i) {
      progress.check();
      Splitter own(refs);
      subtrees[i].reserve((tasks[i].range.end - tasks[i].range.begin));
      build_subtree(own, tasks[i].range, subtrees[i]);
    }
  });
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    // The root of the subtree takes the place that was kept for it; its other nodes are appended.
    const auto shift = std::uint32_t(nodes.size()) - 1;
    for (std::size_t k = 0; k < subtrees[i].size(); ++k) {
      BinaryNode b = subtrees[i][k];
      if (b.count == 0) b.left += shift, b.right += shift;
      if (k == 0)
        nodes[tasks[i].node] = b;
      else
        nodes.push_back(b);
    }
    subtrees[i] = {};
  }
  return nodes;
}

// The node of four for binary node `b`: its children, the largest of them opened until there are four.
std::uint32_t merge(const std::vector<BinaryNode>& binary, std::uint32_t b, std::vector<BvhNode>& nodes) {
  std::array<std::uint32_t, 4> child{b};
  int n = 1;
  while (n < 4) {
    int open = -1;
    for (int i = 0; i < n; ++i)
      if (binary[child[i]].count == 0 &&
          (open < 0 || binary[child[i]].box.half_area() > binary[child[open]].box.half_area()))
        open = i;
    if (open < 0) break;
    child[n++] = binary[child[open]].right;
    child[open] = binary[child[open]].left;
  }
  const auto at = std::uint32_t(nodes.size());
  nodes.emplace_back();
  BvhNode node{};
  node.children = std::uint8_t(n);
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < 3; ++k) {
      node.lo[k][i] = i < n ? binary[child[i]].box.min[k] : infinity;
      node.hi[k][i] = i < n ? binary[child[i]].box.max[k] : infinity;
    }
  for (int i = 0; i < n; ++i) {
    const BinaryNode& c = binary[child[i]];
    node.count[i] = std::uint8_t(c.count);
    node.child[i] = c.count > 0 ? c.first : merge(binary, child[i], nodes);
  }
  nodes[at] = node;
  return at;
}

}  // namespace

Bvh::Bvh(const TriMesh& mesh, const Progress& progress) : mesh_(mesh) {
  Bounds box;
  for (const auto& t : mesh.triangles)
    for (const std::uint32_t v : t) include(box, mesh.points_mm[v]);
  const Vec3 lo = box.min_mm, hi = box.max_mm;
  centre_ = (lo + hi) / 2;
  for (int k = 0; k < 3; ++k) radius_ = std::max(radius_, hi[k] - centre_[k]);

  std::vector<Ref> refs(mesh.triangles.size());
  parallel_for(0, std::int64_t(refs.size()), 1 << 16, [&](std::int64_t from, std::int64_t to) {
    for (std::int64_t i = from; i < to; ++i) {
      refs[i].triangle = std::uint32_t(i);
      for (const std::uint32_t v : mesh.triangles[i]) {
        const Vec3 p = mesh.points_mm[v] - centre_;
        const std::array<float, 3> f{float(p.x), float(p.y), float(p.z)};
        refs[i].box.add(f, f);
      }
    }
  });
  const std::vector<BinaryNode> binary = build_binary(refs, progress);
  nodes_.reserve(binary.size() / 2);
  merge(binary, 0, nodes_);
  order_.resize(refs.size());
  for (std::size_t i = 0; i < refs.size(); ++i) order_[i] = refs[i].triangle;
}

ClosestPoint Bvh::closest_on(Vec3 local, std::uint32_t triangle) const {
  const auto& t = mesh_.triangles[triangle];
  return nearest_on_triangle(local, mesh_.points_mm[t[0]], mesh_.points_mm[t[1]], mesh_.points_mm[t[2]]);
}

ClosestPoint Bvh::nearest(Vec3 local, std::uint32_t seed, double enough_mm, std::uint32_t& triangle) const {
  struct Entry {
    std::uint32_t node;
    float squared;
  };
  const Vec3 p = local - centre_;
  const float q[3] = {float(p.x), float(p.y), float(p.z)};
  // An upper bound of the error from rounding the point, the boxes and their distance to float.
  const double margin = 1e-6 * (std::abs(p.x) + std::abs(p.y) + std::abs(p.z) + radius_);
  const auto limit_of = [&](double squared) {
    const double d = std::sqrt(squared) * (1 + 2e-6) + margin;
    return float(d * d);
  };
  triangle = seed;
  ClosestPoint best = closest_on(local, seed);
  const double enough2 = enough_mm * enough_mm;
  if (best.squared_mm2 <= enough2) return best;
  float limit = limit_of(best.squared_mm2);

  std::array<Entry, 256> stack;  // 3 for each of at most 80 levels
  int size = 0;
  stack[size++] = {0, 0};
  while (size > 0) {
    const Entry e = stack[--size];
    if (e.squared > limit) continue;
    const BvhNode& node = nodes_[e.node];
    float squared[4] = {0, 0, 0, 0};
    for (int k = 0; k < 3; ++k)
      for (int i = 0; i < 4; ++i) {
        const float below = node.lo[k][i] - q[k], above = q[k] - node.hi[k][i];
        float d = below > above ? below : above;
        d = d > 0 ? d : 0;
        squared[i] += d * d;
      }
    int inner[4], inner_count = 0;
    for (int i = 0; i < node.children; ++i) {
      if (squared[i] > limit) continue;
      if (node.count[i] == 0) {
        int at = inner_count++;  // farthest first, so that the nearest is on top of the stack
        for (; at > 0 && squared[inner[at - 1]] < squared[i]; --at) inner[at] = inner[at - 1];
        inner[at] = i;
        continue;
      }
      for (std::uint32_t k = 0; k < node.count[i]; ++k) {
        const std::uint32_t t = order_[node.child[i] + k];
        const ClosestPoint c = closest_on(local, t);
        if (c.squared_mm2 >= best.squared_mm2) continue;
        best = c;
        triangle = t;
        if (best.squared_mm2 <= enough2) return best;
        limit = limit_of(best.squared_mm2);
      }
    }
    for (int i = 0; i < inner_count; ++i) stack[size++] = {node.child[inner[i]], squared[inner[i]]};
  }
  return best;
}

}  // namespace trephine::surface
