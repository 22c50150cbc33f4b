// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "base/disjoint_sets.h"
#include "base/parallel.h"
#include "trunk/clavicle_parts.h"

namespace trephine::trunk {
namespace {

// Of a clavicle, from the middle of all bone; a scan may end beside it, or hold one shoulder alone, which is narrower.
constexpr double max_below_mm = 40, both_sides_mm = 220;
constexpr double min_area_mm2 = 12, max_area_mm2 = 650;
constexpr double max_elongation = 3.2, max_width_mm = 34;
constexpr double min_overlap = 0.3;  ///< of the smaller blob's area, from plane to plane
constexpr double usual_front = 0.5;  ///< more free ways to the front than this share speak for a blob, fewer against it
constexpr double front_reach_mm = 200;
constexpr double longest_mm = 200;
/// A clavicle goes on beyond so wide a gap, of a fracture or where something dense touches it, if both parts are so
/// long.
constexpr double gap_mm = 9, part_mm = 20;
constexpr double max_mean_area_mm2 = 330;  ///< a raised humerus is thicker
constexpr int front_rays = 5;
constexpr double front_fan_deg = 40;

/// The connected pieces (face neighbours) of the plane.
std::vector<Blob> blobs_of(const mask::BitMask& mask, int i) {
  const grid::Lattice& l = mask.lattice();
  const int ny = l.size[1], nz = l.size[2];
  std::vector<Blob::Run> runs;
  std::vector<std::size_t> row_start;
  for (int k = 0; k < nz; ++k) {
    row_start.push_back(runs.size());
    for (int j = 0; j < ny; ++j) {
      if (!mask.get(i, j, k)) continue;
      const int begin = j;
      while (j < ny && mask.get(i, j, k)) ++j;
      runs.push_back({k, begin, j});
    }
  }
  row_start.push_back(runs.size());
  DisjointSets sets(runs.size());
  for (int k = 1; k < nz; ++k)
    for (std::size_t a = row_start[k - 1]; a < row_start[k]; ++a)
      for (std::size_t b = row_start[k]; b < row_start[k + 1]; ++b)
        if (runs[a].begin < runs[b].end && runs[b].begin < runs[a].end) sets.unite(std::uint32_t(a), std::uint32_t(b));
  std::vector<Blob> blobs;
  std::vector<int> number(runs.size(), -1);
  for (std::size_t r = 0; r < runs.size(); ++r) {
    const std::uint32_t first = sets.find(std::uint32_t(r));
    if (number[first] < 0) {
      number[first] = int(blobs.size());
      blobs.push_back({});
      blobs.back().i = i;
    }
    blobs[number[first]].runs.push_back(runs[r]);
  }
  return blobs;
}

void measure(Blob& b, const grid::Lattice& l) {
  const double dy = l.spacing_mm.y, dz = l.spacing_mm.z;
  double n = 0, y = 0, z = 0, yy = 0, yz = 0, zz = 0;
  for (const Blob::Run& r : b.runs)
    for (int j = r.begin; j < r.end; ++j) {
      n += 1, y += j * dy, z += r.k * dz;
      yy += j * dy * j * dy, yz += j * dy * r.k * dz, zz += r.k * dz * r.k * dz;
    }
  y /= n, z /= n;
  yy = yy / n - y * y + dy * dy / 12, zz = zz / n - z * z + dz * dz / 12, yz = yz / n - y * z;
  const double half = (yy + zz) / 2, root = std::sqrt(std::max(0.0, (yy - zz) * (yy - zz) / 4 + yz * yz));
  b.area_mm2 = n * dy * dz;
  b.middle = {double(b.i), y / dy, z / dz};
  b.width_mm = 4 * std::sqrt(half + root);
  b.thickness_mm = 4 * std::sqrt(std::max(0.0, half - root));
}

bool is_round(const Blob& b) {
  return b.area_mm2 >= min_area_mm2 && b.area_mm2 <= max_area_mm2 && b.width_mm <= max_width_mm &&
         b.width_mm <= max_elongation * b.thickness_mm;
}

/// The share of ways to the front, in the plane, on which no other bone stands.
double front_of(const mask::BitMask& mask, const Blob& b) {
  const grid::Lattice& l = mask.lattice();
  const int sign = l.direction.column[1].y > 0 ? -1 : 1;
  int free = 0;
  for (int r = 0; r < front_rays; ++r) {
    const double angle = (2.0 * r / (front_rays - 1) - 1) * front_fan_deg * M_PI / 180;
    const double y = sign * std::cos(angle), z = std::sin(angle);
    bool met = false, left = false;
    for (double t = 0; t < front_reach_mm; t += l.spacing_mm.y) {
      const int j = int(std::lround(b.middle.y + y * t / l.spacing_mm.y)),
                k = int(std::lround(b.middle.z + z * t / l.spacing_mm.z));
      if (j < 0 || k < 0 || j >= l.size[1] || k >= l.size[2]) break;
      const bool bone = mask.get(b.i, j, k);
      if (left && bone) {
        met = true;
        break;
      }
      left = left || !bone;
    }
    free += !met;
  }
  return double(free) / front_rays;
}

double overlap_mm2(const Blob& a, const Blob& b, const grid::Lattice& l) {
  int n = 0;
  std::size_t x = 0, y = 0;
  while (x < a.runs.size() && y < b.runs.size()) {
    const Blob::Run &r = a.runs[x], &s = b.runs[y];
    if (r.k == s.k) n += std::max(0, std::min(r.end, s.end) - std::max(r.begin, s.begin));
    if (r.k < s.k || (r.k == s.k && r.end < s.end))
      ++x;
    else
      ++y;
  }
  return n * l.spacing_mm.y * l.spacing_mm.z;
}

struct Node {
  double weight = 0, sum = 0;
  int before = -1, planes_back = 1;  ///< index into that plane before
  int length = 1;
  bool used = false;
};

/// The sternal end lies in front of the other one.
BodySide side_of(const BlobChain& chain, const grid::Lattice& l) {
  const auto world = [&](const Blob& b) { return l.to_world_mm(b.middle); };
  const Vec3 a = world(chain.blobs.front()), b = world(chain.blobs.back());
  const Vec3 sternal = a.y < b.y ? a : b, shoulder = a.y < b.y ? b : a;
  return shoulder.x > sternal.x ? BodySide::left : BodySide::right;
}

Vec3 middle_of(const mask::BitMask& bone) {
  Vec3 sum;
  double n = 0;
  const grid::Lattice& l = bone.lattice();
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i)
        if (bone.get(i, j, k)) sum += Vec3{double(i), double(j), double(k)}, ++n;
  return l.to_world_mm(sum / n);
}

/// A rib may be as round and as long: a clavicle lies on its own side of the bone's middle, before it, and not far
/// below.
bool lies_as_a_clavicle(const BlobChain& chain, const mask::BitMask& bone, Vec3 middle_mm) {
  const grid::Lattice& l = bone.lattice();
  Vec3 at;
  for (const Blob& b : chain.blobs) at += l.to_world_mm(b.middle);
  at = at / double(chain.blobs.size()) - middle_mm;
  const grid::Box all = bone.bounds();
  const bool has_both_sides = (all.end[0] - all.begin[0]) * l.spacing_mm.x > both_sides_mm;
  return at.y < 0 && at.z > -max_below_mm && (!has_both_sides || (chain.side == BodySide::left) == (at.x > 0));
}

}  // namespace

std::vector<BlobChain> clavicle_chains(const mask::BitMask& core, const ClavicleParams& params,
                                       const Progress& progress) {
  const grid::Lattice& l = core.lattice();
  std::vector<std::vector<Blob>> planes(l.size[0]);
  std::vector<std::vector<Node>> nodes(l.size[0]);
  parallel_for(0, l.size[0], 4, [&](std::int64_t from, std::int64_t to) {
    progress.check();
    for (int i = int(from); i < to; ++i)
      for (Blob& b : blobs_of(core, i)) {
        measure(b, l);
        if (!is_round(b)) continue;
        Node node;
        node.weight = (front_of(core, b) - usual_front) * l.spacing_mm.x;
        nodes[i].push_back(node);
        planes[i].push_back(std::move(b));
      }
  });
  const Vec3 middle_mm = middle_of(core);
  std::vector<BlobChain> found;
  const int longest = int(longest_mm / l.spacing_mm.x), widest_gap = std::max(1, int(gap_mm / l.spacing_mm.x)),
            shortest_part = int(part_mm / l.spacing_mm.x);
  for (int tries = 0; tries < 12 && found.size() < 2; ++tries) {
    double best = 0;
    int end_i = -1, end_n = -1;
    for (int i = 0; i < l.size[0]; ++i)
      for (std::size_t n = 0; n < nodes[i].size(); ++n) {
        Node& node = nodes[i][n];
        node.sum = node.used ? -1e9 : node.weight;
        node.before = -1;
        node.length = 1;
        if (node.used) continue;
        const Blob& here = planes[i][n];
        for (int back = 1; back <= std::min(i, widest_gap); ++back)
          for (std::size_t m = 0; m < nodes[i - back].size(); ++m) {
            const Node& other = nodes[i - back][m];
            const double sum = other.sum + node.weight - usual_front * (back - 1) * l.spacing_mm.x;
            if (other.used || other.sum <= 0 || sum <= node.sum || other.length + back > longest) continue;
            if (back > 1 && other.length < shortest_part) continue;
            const Blob& there = planes[i - back][m];
            if (overlap_mm2(here, there, l) < min_overlap * std::min(here.area_mm2, there.area_mm2)) continue;
            node.sum = sum;
            node.before = int(m);
            node.planes_back = back;
            node.length = other.length + back;
          }
        if (node.sum > best) best = node.sum, end_i = i, end_n = int(n);
      }
    if (end_i < 0) break;
    BlobChain chain;
    double area = 0;
    for (int i = end_i, n = end_n; n >= 0;) {
      // What would hang beyond a gap by itself is of another bone.
      if (int(chain.blobs.size()) < shortest_part && !chain.blobs.empty() && chain.blobs.back().i > i + 1)
        area = 0, chain.blobs.clear();
      Node& node = nodes[i][n];
      node.used = true;
      area += planes[i][n].area_mm2;
      chain.blobs.push_back(planes[i][n]);
      n = node.before, i -= node.planes_back;
    }
    std::reverse(chain.blobs.begin(), chain.blobs.end());
    if (chain.span_mm(l) < params.min_length_mm || area / double(chain.blobs.size()) > max_mean_area_mm2) continue;
    chain.side = side_of(chain, l);
    if (!lies_as_a_clavicle(chain, core, middle_mm)) continue;
    if (!found.empty() && found[0].side == chain.side) continue;
    found.push_back(std::move(chain));
  }
  if (found.size() == 2 && found[0].side == BodySide::left) std::swap(found[0], found[1]);
  return found;
}

}  // namespace trephine::trunk
