// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxel/mismatch.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "base/error.h"
#include "base/parallel.h"
#include "voxel/decode.h"

namespace trephine::voxel {
namespace {

struct SurfaceSample {
  Vec3 point_mm, normal;
};

constexpr double none = std::numeric_limits<double>::infinity();

// Whether a point is in the shape as it is felt.
struct FeltShape {
  const HapticDecoder& decoder;
  int number;
  FeltSurface surface;
  bool holds(Vec3 world_mm) const {
    return (surface == FeltSurface::nearest ? decoder.nearest(number, world_mm) : decoder.trilinear(number, world_mm)) >
           0.5;
  }
};

// Whether the occupancy falls through 1/2 on the way from `from` to `to` (offsets along the normal, from < to); where.
double fall_between(const FeltShape& shape, const SurfaceSample& s, double from, double to) {
  constexpr int halvings = 9;  // of a quarter of a voxel: to 5e-4 of one
  for (int n = 0; n < halvings; ++n) {
    const double middle = (from + to) / 2;
    (shape.holds(s.point_mm + s.normal * middle) ? from : to) = middle;
  }
  return (from + to) / 2;
}

double nearest_fall(const FeltShape& shape, const SurfaceSample& s, double step, double reach) {
  const auto felt = [&](double offset) { return shape.holds(s.point_mm + s.normal * offset); };
  // Searches outwards and inwards step by step: the nearest fall lies in one of the two stretches of the first step
  // that has any.
  const int steps = std::max(1, int(std::ceil(reach / step)));
  const bool here = felt(0);
  bool outer = here, inner = here;
  for (int n = 1; n <= steps; ++n) {
    const double before = (n - 1) * step, after = std::min(n * step, reach);
    const bool next_outer = felt(after), next_inner = felt(-after);
    double best = none;
    if (outer && !next_outer) best = fall_between(shape, s, before, after);
    if (next_inner && !inner) {
      const double in = fall_between(shape, s, -after, -before);
      if (std::abs(in) < std::abs(best)) best = in;
    }
    if (best != none) return best;
    outer = next_outer;
    inner = next_inner;
  }
  return none;
}

bool well_within(const grid::Lattice& l, Vec3 world) {
  const Vec3 i = l.to_index(world);
  for (int a = 0; a < 3; ++a)
    if (!(i[a] >= 1 && i[a] <= l.size[std::size_t(a)] - 2)) return false;
  return true;
}

// One point in each of `count` stretches of equal area, in the order of the triangles.
std::vector<SurfaceSample> samples_on(const surface::TriMesh& mesh, std::int64_t count) {
  std::vector<SurfaceSample> samples;
  double total = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) total += norm(surface::triangle_normal(mesh, t)) / 2;
  if (!(total > 0) || !std::isfinite(total) || count < 1) return samples;
  samples.reserve(std::size_t(count));
  // The fractional parts of multiples of 1/g, 1/g^2, 1/g^3 (g^4 = g + 1) fill a cube evenly.
  constexpr double g1 = 0.8191725133961645, g2 = 0.6710436067037893, g3 = 0.5497004779019703;
  const auto fraction = [](double x) { return x - std::floor(x); };
  double passed = 0;
  std::size_t t = 0;
  double area = norm(surface::triangle_normal(mesh, 0)) / 2;
  for (std::int64_t n = 0; n < count; ++n) {
    const double wanted = total * (double(n) + fraction(0.5 + double(n) * g1)) / double(count);
    while (t + 1 < mesh.triangles.size() && (passed + area < wanted || area == 0)) {
      passed += area;
      area = norm(surface::triangle_normal(mesh, ++t)) / 2;
    }
    if (area == 0) continue;
    double u = fraction(0.5 + double(n) * g2), v = fraction(0.5 + double(n) * g3);
    if (u + v > 1) u = 1 - u, v = 1 - v;
    const auto& c = mesh.triangles[t];
    const Vec3 a = mesh.points_mm[c[0]];
    const Vec3 p = a + (mesh.points_mm[c[1]] - a) * u + (mesh.points_mm[c[2]] - a) * v;
    samples.push_back({mesh.origin_mm + p, normalized(surface::triangle_normal(mesh, t))});
  }
  return samples;
}

}  // namespace

Mismatch measure_mismatch(const surface::TriMesh& mesh, const HapticVolume& volume, const HapticShape& shape,
                          const MismatchParams& params, const Progress& progress) {
  surface::check_mesh(mesh);
  const std::vector<SurfaceSample> displayed = samples_on(mesh, params.sample_count);
  const HapticDecoder decoder(volume);
  const FeltShape felt{decoder, shape.number, params.felt};
  const Vec3 h = volume.voxels.spacing_mm;
  const double step = std::min({h.x, h.y, h.z}) / 4, skipped = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> offset(displayed.size(), skipped);
  parallel_for(0, std::int64_t(displayed.size()), 512, [&](std::int64_t from, std::int64_t to) {
    progress.check();
    for (std::int64_t n = from; n < to; ++n) {
      const SurfaceSample& s = displayed[std::size_t(n)];
      if (well_within(volume.voxels, s.point_mm)) offset[std::size_t(n)] = nearest_fall(felt, s, step, params.reach_mm);
    }
  });
  Mismatch m;
  std::vector<double> magnitude;
  double sum = 0, squares = 0;
  for (const double o : offset) {
    if (std::isnan(o)) continue;
    ++m.samples;
    if (o == none) continue;
    sum += o;
    squares += o * o;
    magnitude.push_back(std::abs(o));
  }
  progress.report(1);
  if (m.samples == 0) return m;
  m.missed_ratio = double(m.samples - magnitude.size()) / double(m.samples);
  if (magnitude.empty()) return m;
  std::sort(magnitude.begin(), magnitude.end());
  m.bias_mm = sum / double(magnitude.size());
  m.rms_mm = std::sqrt(squares / double(magnitude.size()));
  // Nearest rank: the smallest value that at least 99 % of the samples do not exceed.
  m.p99_mm = magnitude[(magnitude.size() * 99 + 99) / 100 - 1];
  m.max_mm = magnitude.back();
  return m;
}

}  // namespace trephine::voxel
