// SPDX-License-Identifier: GPL-3.0-or-later
#include "head/ventricles_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "base/pi.h"
#include "head/ventricles_smooth.h"
#include "mask/filters.h"

namespace trephine::head {
namespace {

constexpr double blur_mm = 0.45;       ///< sigma of a scanner's usual kernel for soft tissue
constexpr double finest_mm = 1.25;     ///< slices thicker than this are modelled in parts
constexpr double beside_sigma_mm = 5;  ///< of the tissue beside
constexpr double beside_reach_mm = 3;  ///< what borders on the fluid, not what lies behind it
constexpr float beside_tissue = 0.8f;  ///< the least share of tissue in a voxel that it is measured by
constexpr double band_mm = 5;          ///< where the surface may be
constexpr double min_contrast_hu = 8;
constexpr double min_steepness = 0.3;  ///< of the distance, where walls meet
constexpr double merge_share = 0.8;    ///< voxels are merged up to this share of the window's sigma
constexpr double step_mm = 1;  ///< the most that a round moves the surface, and about how far off it is taken to be
constexpr double shift_share = 0.5;  ///< how much more freely it shifts than it grows
constexpr int rounds = 4;
constexpr double widths[rounds] = {2, 1.65, 1.3, 1};  ///< of the windows, in the finest's
// The window's sigma: the more noise, the wider.
constexpr double window_base_mm = 0.6, window_rate = 0.13, min_window_mm = 1, max_window_mm = 5;

/// Lattice `coarse` with its slices cut into `parts`.
grid::Lattice cut_slices(const grid::Lattice& coarse, int parts) {
  grid::Lattice l = coarse;
  l.size[2] *= parts;
  l.spacing_mm.z /= parts;
  l.origin_mm = coarse.to_world_mm({0, 0, 0.5 * (1.0 / parts - 1)});
  return l;
}

/// Merges a x a x c voxels into means.
grid::Lattice merged_lattice(const grid::Lattice& l, int a, int c) {
  grid::Lattice m = l;
  m.size = {(l.size[0] + a - 1) / a, (l.size[1] + a - 1) / a, (l.size[2] + c - 1) / c};
  m.spacing_mm = {l.spacing_mm.x * a, l.spacing_mm.y * a, l.spacing_mm.z * c};
  m.origin_mm = l.to_world_mm({0.5 * (a - 1), 0.5 * (a - 1), 0.5 * (c - 1)});
  return m;
}

/// Linear interpolation weights of `to` positions in `from` samples: position of t is (t + 0.5) * scale - 0.5.
struct Line {
  std::vector<int> at;
  std::vector<float> part;
  Line(int to, int from, double scale) : at(to), part(to) {
    for (int t = 0; t < to; ++t) {
      const double x = std::clamp((t + 0.5) * scale - 0.5, 0.0, double(from - 1));
      at[t] = std::min(int(x), std::max(0, from - 2));
      part[t] = from > 1 ? float(x - at[t]) : 0.f;
    }
  }
};

/// Between the voxels of grids whose lattice shares its outline with `to` (a merged one), linearly; hands over to
/// `take` the values at each voxel.
template <class F>
void interpolate(const std::array<grid::Grid<float>, 4>& from, const grid::Lattice& to, const Progress& progress,
                 F&& take) {
  const grid::Lattice& l = from[0];
  const Line x(to.size[0], l.size[0], to.spacing_mm.x / l.spacing_mm.x),
      y(to.size[1], l.size[1], to.spacing_mm.y / l.spacing_mm.y),
      z(to.size[2], l.size[2], to.spacing_mm.z / l.spacing_mm.z);
  const std::size_t dx = l.size[0] > 1, dy = l.size[1] > 1 ? l.size[0] : 0,
                    dz = l.size[2] > 1 ? std::size_t(l.size[0]) * l.size[1] : 0;
  parallel_for(0, to.size[2], 4, [&](std::int64_t begin, std::int64_t end) {
    progress.check();
    std::vector<std::array<float, 4>> row(l.size[0]);
    for (int k = int(begin); k < end; ++k)
      for (int j = 0; j < to.size[1]; ++j) {
        for (int i = 0; i < l.size[0]; ++i) {
          const std::size_t v = l.index(i, y.at[j], z.at[k]);
          for (int n = 0; n < 4; ++n) {
            const float* p = &from[n].voxels[v];
            const float a = p[0] + y.part[j] * (p[dy] - p[0]), b = p[dz] + y.part[j] * (p[dz + dy] - p[dz]);
            row[i][n] = a + z.part[k] * (b - a);
          }
        }
        std::array<float, 4> values;
        for (int i = 0; i < to.size[0]; ++i) {
          const int a = x.at[i];
          for (int n = 0; n < 4; ++n) values[n] = row[a][n] + x.part[i] * (row[a + dx][n] - row[a][n]);
          take(to.index(i, j, k), i, j, k, values);
        }
      }
  });
}

/// Slices between those of `from`, by cubic interpolation (Catmull-Rom): linear would flatten what is curved.
grid::Field sliced(const grid::Field& from, const grid::Lattice& to, const Progress& progress) {
  grid::Field out(to);
  const std::size_t slice = std::size_t(to.size[0]) * to.size[1];
  parallel_for(0, to.size[2], 2, [&](std::int64_t begin, std::int64_t end) {
    progress.check();
    for (int k = int(begin); k < end; ++k) {
      const double z = (k + 0.5) * to.spacing_mm.z / from.spacing_mm.z - 0.5;
      const int first = int(std::floor(z)) - 1;
      const double t = z - first - 1;
      const float w[4] = {float(t * (-0.5 + t * (1 - 0.5 * t))), float(1 + t * t * (-2.5 + 1.5 * t)),
                          float(t * (0.5 + t * (2 - 1.5 * t))), float(t * t * (-0.5 + 0.5 * t))};
      float* row = &out.voxels[k * slice];
      for (int n = 0; n < 4; ++n) {
        const float* in = &from.voxels[std::clamp(first + n, 0, from.size[2] - 1) * slice];
        for (std::size_t v = 0; v < slice; ++v) row[v] += w[n] * in[v];
      }
    }
  });
  return out;
}

/// Solves the symmetric, positive definite system a x = b in place (Cholesky); a is the upper triangle by rows.
std::array<float, 4> solved(const std::array<double, 10>& a, const std::array<double, 4>& b) {
  constexpr int at[4][4] = {{0, 1, 2, 3}, {1, 4, 5, 6}, {2, 5, 7, 8}, {3, 6, 8, 9}};
  double c[4][4], y[4];
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j <= i; ++j) {
      double s = a[at[i][j]];
      for (int k = 0; k < j; ++k) s -= c[i][k] * c[j][k];
      c[i][j] = i == j ? std::sqrt(std::max(s, 1e-12)) : s / c[j][j];
    }
  for (int i = 0; i < 4; ++i) {
    double s = b[i];
    for (int k = 0; k < i; ++k) s -= c[i][k] * y[k];
    y[i] = s / c[i][i];
  }
  std::array<float, 4> x;
  double z[4];
  for (int i = 3; i >= 0; --i) {
    double s = y[i];
    for (int k = i + 1; k < 4; ++k) s -= c[k][i] * z[k];
    z[i] = s / c[i][i];
    x[i] = float(z[i]);
  }
  return x;
}

/// A Gaussian in the slices alone.
void blur_slices(grid::Grid<float>& g, double sigma_mm, const Progress& progress) {
  const double spacing = g.spacing_mm.z;
  g.spacing_mm.z = 1000;  // so that no voxel of another slice has any weight
  mask::gaussian(g, sigma_mm, progress);
  g.spacing_mm.z = spacing;
}

/// The derivatives per mm, by central differences.
Vec3 gradient(const grid::Grid<float>& g, int i, int j, int k) {
  const auto along = [&](int at, int size, std::size_t step, double spacing, std::size_t v) {
    const std::size_t back = at > 0 ? step : 0, on = at + 1 < size ? step : 0;
    return (g.voxels[v + on] - g.voxels[v - back]) / (2 * spacing);
  };
  const std::size_t v = g.index(i, j, k), row = std::size_t(g.size[0]);
  return {along(i, g.size[0], 1, g.spacing_mm.x, v), along(j, g.size[1], row, g.spacing_mm.y, v),
          along(k, g.size[2], row * g.size[1], g.spacing_mm.z, v)};
}

/// What the scanner sees of the shape: its share of each voxel, and how a voxel's share changes where the surface
/// moves.
struct Sight {
  grid::Grid<float> share;
  grid::Grid<float> slope;                   ///< with the surface moving outwards, per mm
  std::array<grid::Grid<float>, 3> towards;  ///< with the shape shifting back along the axes, per mm
};

Sight sight_of(const grid::Grid<float>& distance, const grid::Lattice& scanned, const Progress& progress) {
  const grid::Lattice& f = distance;
  grid::Grid<float> seen(f);
  const float width = float(std::cbrt(f.voxel_volume_mm3()));
  parallel_for(0, f.size[2], 1, [&](std::int64_t begin, std::int64_t end) {
    for (int k = int(begin); k < end; ++k)
      for (int j = 0; j < f.size[1]; ++j)
        for (int i = 0; i < f.size[0]; ++i) {
          const float d = distance.at(i, j, k);
          float steepness = 1;
          if (std::abs(d) < 1.5f * width)
            steepness = std::max(float(min_steepness), float(norm(gradient(distance, i, j, k))));
          seen.at(i, j, k) = std::clamp(0.5f + d / (width * steepness), 0.f, 1.f);
        }
  });
  blur_slices(seen, blur_mm, progress);
  Sight s{grid::Grid<float>(scanned),
          grid::Grid<float>(scanned),
          {grid::Grid<float>(scanned), grid::Grid<float>(scanned), grid::Grid<float>(scanned)}};
  const int parts = f.size[2] / scanned.size[2];
  parallel_for(0, scanned.size[2], 1, [&](std::int64_t begin, std::int64_t end) {
    progress.check();
    for (int z = int(begin) * parts; z < int(end) * parts; ++z)
      for (int j = 0; j < f.size[1]; ++j)
        for (int i = 0; i < f.size[0]; ++i) {
          const std::size_t v = scanned.index(i, j, z / parts);
          s.share.voxels[v] += seen.at(i, j, z) / float(parts);
          if (std::abs(distance.at(i, j, z)) > band_mm) continue;
          const Vec3 g = gradient(seen, i, j, z) / parts;
          s.slope.voxels[v] += float(norm(g));
          for (int a = 0; a < 3; ++a) s.towards[a].voxels[v] += float(g[a]);
        }
  });
  return s;
}

/// HU of the fluid, and of the tissue beside it everywhere.
struct Levels {
  double low = 0;
  grid::Grid<float> high;
};

/// False where too little of the fluid is seen unmixed. What looks unmixed is not where the surface lies too far out:
/// the deeper half is believed.
bool measure(Levels& levels, const grid::Grid<float>& hu, const mask::BitMask& known, const grid::Grid<float>& distance,
             const grid::Grid<float>& share, const Progress& progress) {
  constexpr float pure = 0.98f, little = 0.002f;
  constexpr std::size_t min_voxels = 50, few_voxels = 200;
  const grid::Lattice& o = hu;
  const int parts = distance.size[2] / o.size[2];
  std::vector<std::pair<float, float>> fluid;  // how near to the surface, HU
  for (int k = 0; k < o.size[2]; ++k)
    for (int j = 0; j < o.size[1]; ++j)
      for (int i = 0; i < o.size[0]; ++i) {
        if (!(share.at(i, j, k) > pure) || !known.get(i, j, k)) continue;
        float depth = float(fit_far_mm);
        for (int n = 0; n < parts; ++n) depth = std::min(depth, distance.at(i, j, k * parts + n));
        fluid.push_back({-depth, hu.at(i, j, k)});
      }
  if (fluid.size() < min_voxels) return false;
  std::sort(fluid.begin(), fluid.end());
  const std::size_t deep = std::min(fluid.size(), std::max(few_voxels, fluid.size() / 2));
  double sum = 0;
  for (std::size_t n = 0; n < deep; ++n) sum += fluid[n].second;
  levels.low = sum / double(deep);
  grid::Grid<float> weight(o);
  levels.high = grid::Grid<float>(o);
  parallel_for(0, o.size[2], 1, [&](std::int64_t begin, std::int64_t end) {
    for (int k = int(begin); k < end; ++k)
      for (int j = 0; j < o.size[1]; ++j)
        for (int i = 0; i < o.size[0]; ++i) {
          const std::size_t v = o.index(i, j, k);
          const float d = distance.at(i, j, k * parts + parts / 2), tissue = 1 - share.voxels[v];
          if (!known.get(i, j, k) || tissue < beside_tissue || d < -beside_reach_mm) continue;
          weight.voxels[v] = tissue * tissue;
          levels.high.voxels[v] = tissue * (hu.voxels[v] - float(levels.low) * share.voxels[v]);
        }
  });
  mask::gaussian(levels.high, beside_sigma_mm, progress);
  mask::gaussian(weight, beside_sigma_mm, progress);
  double all = 0, all_weight = 0;
  for (std::size_t v = 0; v < o.count(); ++v) all += levels.high.voxels[v], all_weight += weight.voxels[v];
  const float mean = float(all / std::max(all_weight, 1e-9));
  for (std::size_t v = 0; v < o.count(); ++v)
    levels.high.voxels[v] = std::max(float(levels.low + min_contrast_hu),
                                     (levels.high.voxels[v] + little * mean) / (weight.voxels[v] + little));
  return true;
}

/// How far the surface is off at each place: outwards, and a shift along the axes, mm, on the lattice `m`, which merges
/// `a` x `a` x `c` of the scanned voxels.
std::array<grid::Grid<float>, 4> off_by(const grid::Grid<float>& hu, const mask::BitMask& known, const Sight& seen,
                                        const Levels& levels, const grid::Lattice& m, int a, int c, double sigma_mm,
                                        double noise, const Progress& progress) {
  const grid::Lattice& o = hu;
  std::array<grid::Grid<float>, 14> sums;  // the upper triangle of the normal equations, by rows, and their right side
  for (grid::Grid<float>& s : sums) s = grid::Grid<float>(m);
  parallel_for(0, m.size[2], 1, [&](std::int64_t begin, std::int64_t end) {
    const float part = 1.f / float(a * a * c);
    for (int k = int(begin) * c; k < std::min(o.size[2], int(end) * c); ++k)
      for (int j = 0; j < o.size[1]; ++j)
        for (int i = 0; i < o.size[0]; ++i) {
          const std::size_t v = o.index(i, j, k);
          if (!(seen.slope.voxels[v] > 1e-4f) || !known.get(i, j, k)) continue;
          const float contrast = levels.high.voxels[v] - float(levels.low);
          const float missing = levels.high.voxels[v] - contrast * seen.share.voxels[v] - hu.voxels[v];
          const float d[4] = {contrast * seen.slope.voxels[v], -contrast * seen.towards[0].voxels[v],
                              -contrast * seen.towards[1].voxels[v], -contrast * seen.towards[2].voxels[v]};
          const std::size_t w = m.index(i / a, j / a, k / c);
          int n = 0;
          for (int row = 0; row < 4; ++row)
            for (int column = row; column < 4; ++column) sums[n++].voxels[w] += part * d[row] * d[column];
          for (int row = 0; row < 4; ++row) sums[n++].voxels[w] += part * d[row] * missing;
        }
  });
  for (grid::Grid<float>& s : sums) mask::gaussian(s, sigma_mm, progress);
  // What noise alone would make of it has the variance noise^2 over the window's weight.
  constexpr double two_pi = 2 * pi;
  const double ridge = noise * noise / (std::pow(two_pi, 1.5) * sigma_mm * sigma_mm * sigma_mm * step_mm * step_mm);
  std::array<grid::Grid<float>, 4> off{grid::Grid<float>(m), grid::Grid<float>(m), grid::Grid<float>(m),
                                       grid::Grid<float>(m)};
  parallel_for(0, std::int64_t(m.count()), 4096, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t v = begin; v < end; ++v) {
      if (!(sums[0].voxels[v] > 1e-3 * ridge)) continue;
      std::array<double, 10> left;
      std::array<double, 4> right;
      for (int n = 0; n < 10; ++n) left[n] = sums[n].voxels[v];
      for (int n = 0; n < 4; ++n) right[n] = sums[10 + n].voxels[v];
      left[0] += ridge + 1e-9;
      for (const int n : {4, 7, 9}) left[n] += shift_share * ridge + 1e-9;
      const std::array<float, 4> x = solved(left, right);
      for (int n = 0; n < 4; ++n) off[n].voxels[v] = x[n];
    }
  });
  return off;
}

}  // namespace

grid::Field fit_fluid(const grid::Grid<float>& hu, const mask::BitMask& known, const grid::Field& start, double noise,
                      const mask::BitMask* necks, const Progress& progress) {
  const grid::Lattice& o = hu;
  const grid::Lattice f = cut_slices(o, std::max(1, int(std::ceil(o.spacing_mm.z / finest_mm))));
  grid::Field distance = sliced(start, f, progress);
  const double window = std::clamp(window_base_mm + window_rate * noise, min_window_mm, max_window_mm);
  const int a = std::max(1, int(merge_share * window / std::max(o.spacing_mm.x, o.spacing_mm.y))),
            c = std::max(1, int(merge_share * window / o.spacing_mm.z));
  const grid::Lattice m = merged_lattice(o, a, c);
  Levels levels;
  for (int round = 0; round < rounds; ++round) {
    smooth_fit(distance, necks, progress);
    const Sight seen = sight_of(distance, o, progress);
    if (!measure(levels, hu, known, distance, seen.share, progress)) break;
    const auto off = off_by(hu, known, seen, levels, m, a, c, widths[round] * window, noise, progress);
    const grid::Field before = distance;
    interpolate(off, f, progress, [&](std::size_t v, int i, int j, int k, const std::array<float, 4>& u) {
      if (std::abs(before.voxels[v]) > band_mm) return;
      const Vec3 g = gradient(before, i, j, k);
      const double way = std::max(min_steepness, norm(g)) * u[0] - (u[1] * g.x + u[2] * g.y + u[3] * g.z);
      distance.voxels[v] += float(std::clamp(way, -step_mm, step_mm));
    });
  }
  return distance;
}

}  // namespace trephine::head
