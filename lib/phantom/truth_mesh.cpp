// SPDX-License-Identifier: GPL-3.0-or-later
// Marching tetrahedra [Doi1991] over Freudenthal's division of each cube into six [Bloomenthal1994]. The division is
// the same from both sides of every face, so the surface is always closed and manifold.
#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"
#include "phantom/truth.h"
#include "surface/bounds.h"

namespace trephine::phantom {
namespace {

/// Values of the clipped solid at the lattice's points: max(anatomy, region). Blocks without a surface hold its sign
/// only.
struct Samples {
  std::array<int, 3> n;
  Vec3 origin, step;
  std::vector<float> value;
  Vec3 at(int i, int j, int k) const { return {origin.x + i * step.x, origin.y + j * step.y, origin.z + k * step.z}; }
  std::size_t index(int i, int j, int k) const { return (static_cast<std::size_t>(k) * n[1] + j) * n[0] + i; }
};

Samples sample_solid(const Head& head, Anatomy anatomy, const ScannedRegion& region, double step_mm,
                     const Progress& progress) {
  const surface::Bounds& box = region.box_mm;
  Samples s;
  for (int a = 0; a < 3; ++a) {
    const double length = box.max_mm[a] - box.min_mm[a];
    const int cells = std::max(1, static_cast<int>(std::ceil(length / step_mm)));
    s.step[a] = length / cells;
    s.origin[a] = box.min_mm[a] - 0.5 * s.step[a];  // the box's faces lie halfway between points
    s.n[a] = cells + 2;
  }
  s.value.resize(static_cast<std::size_t>(s.n[0]) * s.n[1] * s.n[2]);
  constexpr int block = 6;
  const int layers = (s.n[2] + block - 1) / block;
  parallel_for(0, layers, 1, [&](std::int64_t from, std::int64_t to) {
    for (int layer = static_cast<int>(from); layer < to; ++layer) {
      progress.check();
      const int k0 = layer * block, k1 = std::min(s.n[2], k0 + block);
      for (int j0 = 0; j0 < s.n[1]; j0 += block)
        for (int i0 = 0; i0 < s.n[0]; i0 += block) {
          const int i1 = std::min(s.n[0], i0 + block), j1 = std::min(s.n[1], j0 + block);
          const Vec3 low = s.at(i0, j0, k0), high = s.at(i1 - 1, j1 - 1, k1 - 1);
          const double middle = head.implicit_mm(anatomy, (low + high) * 0.5);
          const bool plain = std::fabs(middle) > 0.75 * norm(high - low) + 4;
          for (int k = k0; k < k1; ++k)
            for (int j = j0; j < j1; ++j)
              for (int i = i0; i < i1; ++i) {
                const Vec3 p = s.at(i, j, k);
                const double f = plain ? middle : head.implicit_mm(anatomy, p);
                s.value[s.index(i, j, k)] = static_cast<float>(std::max(f, region.beyond_mm(p)));
              }
        }
    }
  });
  return s;
}

/// Corner c of a cube is the point (i + (c & 1), j + (c >> 1 & 1), k + (c >> 2)). All six tetrahedra share the diagonal
/// 0-7 and are oriented alike.
constexpr int tetrahedra[6][4] = {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7}, {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}};

class Marcher {
 public:
  explicit Marcher(const Samples& s) : s_(s), layer_points_(static_cast<std::size_t>(s.n[0]) * s.n[1]) {
    for (auto& l : edges_) l.assign(layer_points_ * 7, none);
  }

  surface::TriMesh run(const Progress& progress) {
    for (int k = 0; k + 1 < s_.n[2]; ++k) {
      progress.check();
      for (int j = 0; j + 1 < s_.n[1]; ++j)
        for (int i = 0; i + 1 < s_.n[0]; ++i) cube(i, j, k);
      std::swap(edges_[0], edges_[1]);
      std::fill(edges_[1].begin(), edges_[1].end(), none);
    }
    return std::move(mesh_);
  }

 private:
  static constexpr std::uint32_t none = 0xffffffffu;

  void cube(int i, int j, int k) {
    int inside = 0;
    for (int c = 0; c < 8; ++c) {
      corner_[c] = s_.value[s_.index(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2))];
      inside |= (corner_[c] < 0) << c;
    }
    if (inside == 0 || inside == 255) return;
    i_ = i, j_ = j, k_ = k;
    for (const auto& t : tetrahedra) tetrahedron(t);
  }

  void tetrahedron(const int (&t)[4]) {
    int in[4], out[4], ins = 0, outs = 0;
    for (int v = 0; v < 4; ++v) (corner_[t[v]] < 0 ? in[ins++] : out[outs++]) = v;
    if (ins == 0 || outs == 0) return;
    const auto crossing = [&](int a, int b) { return point(t[a], t[b]); };
    if (ins == 1 || outs == 1) {
      const int lone = ins == 1 ? in[0] : out[0];
      // The other three in the order in which they look counter-clockwise from the lone corner's far side.
      static constexpr int others[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
      const int(&o)[3] = others[lone];
      const std::uint32_t a = crossing(lone, o[0]), b = crossing(lone, o[1]), c = crossing(lone, o[2]);
      ins == 1 ? add(a, b, c) : add(a, c, b);
    } else {
      const std::uint32_t a = crossing(in[0], out[0]), b = crossing(in[0], out[1]), c = crossing(in[1], out[1]),
                          d = crossing(in[1], out[0]);
      // Even or odd: whether (in0, in1, out0, out1) is an even permutation of the tetrahedron.
      const int order[4] = {in[0], in[1], out[0], out[1]};
      int swaps = 0;
      for (int x = 0; x < 4; ++x)
        for (int y = x + 1; y < 4; ++y) swaps += order[x] > order[y];
      if (swaps % 2 == 0) {
        add(a, b, c);
        add(a, c, d);
      } else {
        add(a, c, b);
        add(a, d, c);
      }
    }
  }

  void add(std::uint32_t a, std::uint32_t b, std::uint32_t c) { mesh_.triangles.push_back({a, b, c}); }

  /// The point where the edge between two corners crosses zero; made once.
  std::uint32_t point(int a, int b) {
    if ((a & b) == b) std::swap(a, b);  // a is the lower corner: its bits are a subset of b's
    const int di = (a & 1), dj = (a >> 1 & 1), dk = a >> 2, direction = (b ^ a) - 1;
    const std::size_t at = (static_cast<std::size_t>(j_ + dj) * s_.n[0] + i_ + di) * 7 + direction;
    std::uint32_t& slot = edges_[dk][at];
    if (slot == none) {
      const double fa = corner_[a], fb = corner_[b], t = std::clamp(fa / (fa - fb), 1e-3, 1 - 1e-3);
      const Vec3 pa = s_.at(i_ + di, j_ + dj, k_ + dk), pb = s_.at(i_ + (b & 1), j_ + (b >> 1 & 1), k_ + (b >> 2));
      slot = static_cast<std::uint32_t>(mesh_.points_mm.size());
      mesh_.points_mm.push_back(pa + (pb - pa) * t);
    }
    return slot;
  }

  const Samples& s_;
  std::size_t layer_points_;
  std::array<std::vector<std::uint32_t>, 2> edges_;
  std::array<float, 8> corner_{};
  int i_ = 0, j_ = 0, k_ = 0;
  surface::TriMesh mesh_;
};

}  // namespace

double ScannedRegion::beyond_mm(Vec3 p) const {
  const surface::Bounds& b = box_mm;
  double beyond = std::max(
      {b.min_mm.x - p.x, p.x - b.max_mm.x, b.min_mm.y - p.y, p.y - b.max_mm.y, b.min_mm.z - p.z, p.z - b.max_mm.z});
  for (const Face& f : faces) beyond = std::max(beyond, dot(f.normal, p) - f.offset_mm);
  return beyond;
}

surface::TriMesh truth_mesh(const Head& head, Anatomy anatomy, const ScannedRegion& region, double step_mm,
                            const Progress& progress) {
  const Samples samples = sample_solid(head, anatomy, region, step_mm, progress);
  surface::TriMesh mesh = Marcher(samples).run(progress);
  // Onto the analytic surface, by at most half a step: farther means a crease that the lattice cannot show.
  parallel_for(0, static_cast<std::int64_t>(mesh.points_mm.size()), 4096, [&](std::int64_t from, std::int64_t to) {
    progress.check();
    for (std::int64_t i = from; i < to; ++i) {
      Vec3& p = mesh.points_mm[i];
      if (std::fabs(head.implicit_mm(anatomy, p)) > step_mm || region.beyond_mm(p) > -1e-9) continue;  // on a cap
      Vec3 x = p, g;
      for (int n = 0; n < 6; ++n) {
        const double f = head.implicit_mm(anatomy, x, g);
        x += g * (-f / std::max(1e-6, dot(g, g)));
        if (std::fabs(f) < 1e-7) break;
      }
      if (norm(x - p) < 0.75 * step_mm && region.beyond_mm(x) <= 0) p = x;
    }
  });
  return mesh;
}

ScannedRegion scanned_region(const ScanParams& params) {
  std::vector<SlicePose> slices = slice_poses(params);
  if (has_pose(params)) {
    const itk::LinearMap to_head = itk::inverse(head_pose(params));
    for (SlicePose& s : slices) s = {to_head(s.origin_mm), to_head.matrix * s.row, to_head.matrix * s.column};
  }
  const double pixel_mm = pixel_spacing_mm(params);
  std::vector<Vec3> corners;
  for (const SlicePose& s : slices)
    for (int c = 0; c < 4; ++c)
      corners.push_back(s.origin_mm + s.row * (c & 1 ? (params.columns_count - 1) * pixel_mm : 0) +
                        s.column * (c & 2 ? (params.rows_count - 1) * pixel_mm : 0));
  ScannedRegion region;
  for (const Vec3 p : corners) surface::include(region.box_mm, p);
  const Vec3 row = slices[0].row, column = slices[0].column, feed = slices.back().origin_mm - slices[0].origin_mm;
  for (const Vec3 across : {cross(row, column), cross(row, feed), cross(column, feed)}) {
    if (!(norm(across) > 0)) continue;  // the plane of a single slice has no normal
    const Vec3 normal = normalized(across);
    if (std::max({std::abs(normal.x), std::abs(normal.y), std::abs(normal.z)}) > 1 - 1e-12) continue;  // the box's
    double low = dot(normal, corners[0]), high = low;
    for (const Vec3 p : corners) {
      low = std::min(low, dot(normal, p));
      high = std::max(high, dot(normal, p));
    }
    region.faces.push_back({normal, high});
    region.faces.push_back({normal * -1.0, -low});
  }
  return region;
}

}  // namespace trephine::phantom
