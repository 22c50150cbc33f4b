// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Small analytic scans of a spine and of a chest, and how far a field's surface lies from the truth, both ways, in mm.
#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "base/parallel.h"
#include "grid/grid.h"
#include "mask/filters.h"
#include "random.h"

namespace trephine::bodies {

inline double gauss(Random& r) {  // Box and Muller
  const double u = std::max(r(), 1e-12), v = r();
  return std::sqrt(-2 * std::log(u)) * std::cos(2 * M_PI * v);
}

/// HU of each voxel: mean of 2 x 2 x 2 points.
inline grid::Grid<float> drawn(const grid::Lattice& l, const std::function<float(Vec3)>& hu) {
  grid::Grid<float> g(l);
  parallel_for(0, l.size[2], 1, [&](std::int64_t from, std::int64_t to) {
    for (int k = int(from); k < to; ++k)
      for (int j = 0; j < l.size[1]; ++j)
        for (int i = 0; i < l.size[0]; ++i) {
          float sum = 0;
          for (int s = 0; s < 8; ++s)
            sum += hu(l.to_world_mm({i + (s & 1 ? .25 : -.25), j + (s & 2 ? .25 : -.25), k + (s & 4 ? .25 : -.25)}));
          g.at(i, j, k) = sum / 8;
        }
  });
  return g;
}

/// Blurred, with white noise, rounded.
inline grid::HuVolume scanned(grid::Grid<float> g, double blur_mm, double noise_hu, std::uint64_t seed = 1) {
  if (blur_mm > 0) mask::gaussian(g, blur_mm);
  grid::Grid<std::int16_t> out(g);
  Random random(seed);
  for (std::size_t v = 0; v < g.count(); ++v)
    out.voxels[v] = std::int16_t(std::lround(g.voxels[v] + noise_hu * gauss(random)));
  return out;
}

/// Distance to a line through the points.
inline double to_line(const std::vector<Vec3>& line, Vec3 p) {
  double best = 1e300;
  for (std::size_t n = 1; n < line.size(); ++n) {
    const Vec3 a = line[n - 1], way = line[n] - a;
    best = std::min(best, norm(p - a - way * std::clamp(dot(p - a, way) / dot(way, way), 0.0, 1.0)));
  }
  return best;
}

/// The distance to the line, exact up to reach_mm, which stands for all beyond.
inline grid::Grid<float> distances(const grid::Lattice& l, const std::vector<Vec3>& line, double reach_mm) {
  grid::Grid<float> d(l, float(reach_mm));
  for (std::size_t n = 1; n < line.size(); ++n) {
    const std::vector<Vec3> piece{line[n - 1], line[n]};
    int from[3], to[3];
    for (int a = 0; a < 3; ++a) {
      const double low = std::min(piece[0][a], piece[1][a]) - reach_mm,
                   high = std::max(piece[0][a], piece[1][a]) + reach_mm;
      from[a] = std::max(0, int((low - l.origin_mm[a]) / l.spacing_mm[a]));
      to[a] = std::min(l.size[a] - 1, int((high - l.origin_mm[a]) / l.spacing_mm[a]) + 1);
    }
    for (int k = from[2]; k <= to[2]; ++k)
      for (int j = from[1]; j <= to[1]; ++j)
        for (int i = from[0]; i <= to[0]; ++i)
          d.at(i, j, k) =
              std::min(d.at(i, j, k), float(to_line(piece, l.to_world_mm({double(i), double(j), double(k)}))));
  }
  return d;
}

/// A tube around the line, with its share of the voxels at its surface.
inline void draw_tube(grid::Grid<float>& g, const std::vector<Vec3>& line, double radius_mm, float hu) {
  const grid::Grid<float> d = distances(g, line, radius_mm + 3);
  const double voxel_mm = std::cbrt(g.voxel_volume_mm3());
  for (std::size_t v = 0; v < g.count(); ++v) {
    const float share = float(std::clamp(0.5 + (radius_mm - d.voxels[v]) / voxel_mm, 0.0, 1.0));
    g.voxels[v] += share * (hu - g.voxels[v]);
  }
}

/// The points where the field changes sign on the lattice's edges.
inline std::vector<Vec3> crossings(const grid::Field& f) {
  std::vector<Vec3> points;
  for (int k = 0; k < f.size[2]; ++k)
    for (int j = 0; j < f.size[1]; ++j)
      for (int i = 0; i < f.size[0]; ++i)
        for (int a = 0; a < 3; ++a) {
          const int x = i + (a == 0), y = j + (a == 1), z = k + (a == 2);
          if (!f.contains(x, y, z)) continue;
          const float u = f.at(i, j, k), v = f.at(x, y, z);
          if ((u > 0) == (v > 0)) continue;
          Vec3 p{double(i), double(j), double(k)};
          p[a] += u / (u - v);
          points.push_back(f.to_world_mm(p));
        }
  return points;
}

/// Distances to the nearest of many points, by cells of 2 mm.
class Nearest {
 public:
  explicit Nearest(const std::vector<Vec3>& points) : points_(points) {
    Vec3 hi{-1e300, -1e300, -1e300};
    lo_ = {1e300, 1e300, 1e300};
    for (const Vec3& p : points)
      for (int a = 0; a < 3; ++a) lo_[a] = std::min(lo_[a], p[a]), hi[a] = std::max(hi[a], p[a]);
    for (int a = 0; a < 3; ++a) n_[a] = points.empty() ? 1 : int((hi[a] - lo_[a]) / 2) + 1;
    cells_.resize(std::size_t(n_[0]) * n_[1] * n_[2]);
    for (std::size_t q = 0; q < points.size(); ++q) cells_[cell(points[q])].push_back(q);
  }
  double operator()(Vec3 p) const {
    double best = 1e300;
    for (const double reach : {3.0, 8.0, 20.0}) {
      int from[3], to[3];
      for (int a = 0; a < 3; ++a) {
        from[a] = std::clamp(int((p[a] - reach - lo_[a]) / 2), 0, n_[a] - 1);
        to[a] = std::clamp(int((p[a] + reach - lo_[a]) / 2), 0, n_[a] - 1);
      }
      for (int z = from[2]; z <= to[2]; ++z)
        for (int y = from[1]; y <= to[1]; ++y)
          for (int x = from[0]; x <= to[0]; ++x)
            for (std::size_t q : cells_[(std::size_t(z) * n_[1] + y) * n_[0] + x])
              best = std::min(best, norm(points_[q] - p));
      if (best <= reach) return best;
    }
    return std::min(best, 1000.0);
  }

 private:
  std::size_t cell(Vec3 p) const {
    int c[3];
    for (int a = 0; a < 3; ++a) c[a] = std::clamp(int((p[a] - lo_[a]) / 2), 0, n_[a] - 1);
    return (std::size_t(c[2]) * n_[1] + c[1]) * n_[0] + c[0];
  }
  const std::vector<Vec3>& points_;
  Vec3 lo_;
  int n_[3];
  std::vector<std::vector<std::size_t>> cells_;
};

struct Distances {
  double mean = 0, p95 = 0, max = 0;
};
inline Distances summary(std::vector<double> d) {
  Distances s;
  if (d.empty()) return {1e9, 1e9, 1e9};
  std::sort(d.begin(), d.end());
  for (double v : d) s.mean += v / double(d.size());
  s.p95 = d[std::size_t(0.95 * double(d.size() - 1))];
  s.max = d.back();
  return s;
}

/// Both ways: the field's surface to the truth's (a signed distance), and the truth's (crossings of `true_field`, the
/// same distance on a lattice of voxels) to the field's. `counts` says where to look.
inline Distances surface_distance(const grid::Field& field, const grid::Field& true_field,
                                  const std::function<double(Vec3)>& truth_mm,
                                  const std::function<bool(Vec3)>& counts) {
  const std::vector<Vec3> found = crossings(field), truth = crossings(true_field);
  const Nearest to_found(found);
  std::vector<double> d;
  for (const Vec3& p : found)
    if (counts(p)) d.push_back(std::abs(truth_mm(p)));
  for (const Vec3& p : truth)
    if (counts(p)) d.push_back(to_found(p));
  return summary(std::move(d));
}

inline double volume_mm3(const grid::Field& f, const std::function<bool(Vec3)>& counts) {
  double n = 0;
  for (int k = 0; k < f.size[2]; ++k)
    for (int j = 0; j < f.size[1]; ++j)
      for (int i = 0; i < f.size[0]; ++i)
        n += f.at(i, j, k) > 0 && counts(f.to_world_mm({double(i), double(j), double(k)}));
  return n * f.voxel_volume_mm3();
}

inline grid::Lattice lattice(int x, int y, int z, Vec3 spacing_mm, Vec3 origin_mm) {
  grid::Lattice l;
  l.size = {x, y, z};
  l.spacing_mm = spacing_mm;
  l.origin_mm = origin_mm;
  return l;
}

}  // namespace trephine::bodies
