// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/smooth.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/error.h"
#include "base/parallel.h"
#include "base/refusal.h"
#include "meshing/feature_smooth.h"
#include "meshing/normals.h"
#include "meshing/reference_distance.h"
#include "meshing/validity.h"
#include "surface/incidence.h"

namespace trephine::meshing {
namespace {

constexpr std::int64_t grain = 16384;

/// Each point's neighbours along edges, as one flat list.
struct Neighbours {
  std::vector<std::uint32_t> begin, point;

  Neighbours(const surface::TriMesh& mesh, const surface::Incidence& incidence) : begin(mesh.points_mm.size() + 1, 0) {
    // On a closed, oriented surface each triangle around a point adds the corner that follows it.
    point.resize(incidence.triangle.size());
    begin = incidence.begin;
    parallel_for(0, static_cast<std::int64_t>(mesh.points_mm.size()), grain, [&](std::int64_t from, std::int64_t to) {
      for (std::int64_t p = from; p < to; ++p)
        for (std::uint32_t n = begin[p]; n < begin[p + 1]; ++n) {
          const auto& v = mesh.triangles[incidence.triangle[n]];
          point[n] = v[0] == p ? v[1] : v[1] == p ? v[2] : v[0];
        }
    });
  }
};

/// Coefficients of the Chebyshev polynomials of the low-pass filter: those of an ideal filter under a Hamming window,
/// shifted so that the filter is 1 at frequency 0. A constant then passes unchanged, and nothing shrinks to the origin.
std::vector<double> filter_coefficients(int degree, double pass_band) {
  std::vector<double> c(degree + 1);
  const double theta = std::acos(std::clamp(1 - pass_band / 2, -1.0, 1.0));
  double sum = 0;
  for (int n = 0; n <= degree; ++n) {
    const double window = 0.54 + 0.46 * std::cos(n * M_PI / (degree + 1));
    c[n] = window * (n == 0 ? theta / M_PI : 2 * std::sin(n * theta) / (n * M_PI));
    sum += c[n];
  }
  for (double& v : c) v /= sum;
  return c;
}

/// y = (I - K/2) x with K the umbrella operator x - mean of neighbours: K's eigenvalues lie in 0 to 2.
void half_step(const Neighbours& neighbours, const std::vector<Vec3>& x, std::vector<Vec3>& y) {
  parallel_for(0, static_cast<std::int64_t>(x.size()), grain, [&](std::int64_t from, std::int64_t to) {
    for (std::int64_t p = from; p < to; ++p) {
      Vec3 sum;
      const std::uint32_t b = neighbours.begin[p], e = neighbours.begin[p + 1];
      for (std::uint32_t n = b; n < e; ++n) sum += x[neighbours.point[n]];
      y[p] = e > b ? (x[p] + sum / double(e - b)) * 0.5 : x[p];
    }
  });
}

/// The filter as a sum of Chebyshev polynomials of (I - K/2), by their recurrence.
std::vector<Vec3> low_pass(const surface::TriMesh& mesh, const SmoothParams& params, const Progress& progress) {
  const auto degree = static_cast<int>(params.iterations_count);
  const Neighbours neighbours(mesh, surface::Incidence(mesh));
  const std::vector<double> c = filter_coefficients(degree, params.pass_band_ratio);
  std::vector<Vec3> before = mesh.points_mm, now(before.size()), next(before.size()), sum(before.size());
  half_step(neighbours, before, now);
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] = before[i] * c[0] + now[i] * c[1];
  for (int n = 2; n <= degree; ++n) {
    progress.report(double(n) / degree);
    half_step(neighbours, now, next);
    parallel_for(0, static_cast<std::int64_t>(sum.size()), grain, [&](std::int64_t from, std::int64_t to) {
      for (std::int64_t i = from; i < to; ++i) {
        next[i] = next[i] * 2.0 - before[i];
        sum[i] += next[i] * c[n];
      }
    });
    before.swap(now);
    now.swap(next);
  }
  return sum;
}

std::vector<Vec3> neighbour_means(const surface::TriMesh& mesh, std::int64_t iterations, const Progress& progress) {
  const Neighbours neighbours(mesh, surface::Incidence(mesh));
  std::vector<Vec3> now = mesh.points_mm, next(now.size());
  for (std::int64_t n = 0; n < iterations; ++n) {
    progress.report(double(n) / double(iterations));
    half_step(neighbours, now, next);
    now.swap(next);
  }
  return now;
}

std::vector<Vec3> filtered(const surface::TriMesh& mesh, const SmoothParams& params, const Progress& progress) {
  switch (params.method) {
    case SmoothMethod::laplacian:
      return neighbour_means(mesh, params.iterations_count, progress);
    case SmoothMethod::feature:
      return fit_to_filtered_normals(mesh, params.iterations_count, params.feature_angle_deg, progress);
    case SmoothMethod::windowed_sinc:
      break;
  }
  return low_pass(mesh, params, progress);
}

/// Points of the faulty triangles go back to where they were, with `rings` rings around them.
void take_back(surface::TriMesh& mesh, const surface::TriMesh& original, std::vector<char>& held,
               const std::vector<std::uint32_t>& triangles, int rings) {
  std::vector<char> marked(mesh.points_mm.size(), 0);
  for (const std::uint32_t t : triangles)
    for (const std::uint32_t v : mesh.triangles[t]) marked[v] = 1;
  for (int r = 0; r < rings; ++r) {
    std::vector<char> more = marked;
    for (const auto& t : mesh.triangles)
      if (marked[t[0]] || marked[t[1]] || marked[t[2]])
        for (const std::uint32_t v : t) more[v] = 1;
    marked.swap(more);
  }
  for (std::size_t i = 0; i < marked.size(); ++i)
    if (marked[i]) {
      mesh.points_mm[i] = original.points_mm[i];
      held[i] = 1;
    }
}

/// Moves each point along its normal towards its target. What the volume loses is given back by an even offset, as far
/// as the bound allows. Sliding along the surface would use up the bound where triangles are uneven, for nothing.
void move_points(surface::TriMesh& mesh, const surface::TriMesh& original, const std::vector<Vec3>& target,
                 double volume, double max_displacement_mm) {
  surface::TriMesh shape = original;
  compute_normals(shape, NormalsParams());
  const double step = float32_step_mm(original), area = surface::area_mm2(original);
  // Rounding to float32 moves a point by less than one step of the grid, so the bound holds after it as well.
  const double limit = std::max(0.0, max_displacement_mm - step);
  double offset = 0;
  for (int round = 0; round < 4; ++round) {
    for (std::size_t i = 0; i < target.size(); ++i) {
      const Vec3 n = shape.normals[i], from = original.points_mm[i];
      Vec3 p = from + n * std::clamp(dot(n, target[i] - from) + offset, -limit, limit);
      for (int a = 0; a < 3; ++a) p[a] = std::nearbyint(p[a] / step) * step;
      mesh.points_mm[i] = p;
    }
    offset += (volume - surface::volume_mm3(mesh)) / area;
  }
}

std::vector<std::uint32_t> faulty_triangles(const surface::TriMesh& mesh, const Progress& progress) {
  std::vector<std::uint32_t> faults = degenerate_triangles(mesh);
  for (const auto& pair : self_intersections(mesh, progress)) faults.insert(faults.end(), pair.begin(), pair.end());
  return faults;
}

/// The triangles of pieces that were turned inside out.
std::vector<std::uint32_t> turned_triangles(const surface::TriMesh& mesh, const surface::TriMesh& original) {
  std::vector<int> piece_of;
  const int pieces = surface::label_components(mesh, piece_of);
  const auto before = surface::piece_volumes(original, piece_of, pieces),
             now = surface::piece_volumes(mesh, piece_of, pieces);
  std::vector<std::uint32_t> found;
  for (std::uint32_t t = 0; t < piece_of.size(); ++t)
    if (!(before[piece_of[t]] * now[piece_of[t]] > 0)) found.push_back(t);
  return found;
}

}  // namespace

Outcome<surface::TriMesh, SmoothResult> smooth(const surface::TriMesh& input, const SmoothParams& params,
                                               const Progress& progress, const surface::TriMesh* reference) {
  surface::check_mesh(input);
  const double bound_mm = params.total_deviation_mm;
  if (bound_mm > 0 && !reference)
    throw Error(ExitCode::usage, "", "total_deviation_mm", "is to a reference, and none is given");
  if (reference) with_field("reference", [&] { surface::check_mesh(*reference); });
  surface::TriMesh original = input;
  original.normals.clear();
  snap_to_float32(original);
  with_field("smooth: input", [&] { require_valid(original, progress.part(0, 0.2)); });
  std::optional<DistanceToReference> to_reference;
  if (reference) to_reference.emplace(*reference, original.origin_mm);
  if (bound_mm > 0 && !to_reference->beyond(original, bound_mm, progress).empty())
    throw refusal("smooth: reference",
                  fmt::format("the surface lies further from it before it is smoothed than total_deviation_mm, {}: up "
                              "to {:.3f} mm at its points",
                              bound_mm, to_reference->largest_mm(original)),
                  {"raise `total_deviation_mm`, or lower `max_deviation_mm` of `decimate`"});
  surface::TriMesh mesh = original;
  const double volume = surface::volume_mm3(original);
  double strength = 1;
  std::vector<char> held(mesh.points_mm.size(), 0);
  if (params.iterations_count > 0 && params.max_displacement_mm > 0) {
    std::vector<Vec3> target = filtered(original, params, progress.part(0.2, 0.6));
    for (;;) {
      move_points(mesh, original, target, volume, params.max_displacement_mm);
      std::fill(held.begin(), held.end(), 0);
      for (int round = 0, rings = 0;;) {
        auto faults = faulty_triangles(mesh, progress.part(0.6, 0.9));
        if (faults.empty()) faults = turned_triangles(mesh, original);
        if (!faults.empty()) {
          take_back(mesh, original, held, faults, std::min(round++, 1000));
          continue;
        }
        if (bound_mm > 0) faults = to_reference->beyond(mesh, bound_mm, progress);
        if (faults.empty()) break;
        // Many places may be at the bound: each goes back by itself; its surroundings only where it is back already.
        const auto before = std::count(held.begin(), held.end(), 1);
        take_back(mesh, original, held, faults, rings);
        rings = std::count(held.begin(), held.end(), 1) > before ? 0 : rings + 1;
      }
      if (!(100 * std::abs(surface::volume_mm3(mesh) / volume - 1) > params.max_volume_change_percent)) break;
      strength = strength > 0.01 ? strength / 2 : 0;
      if (strength == 0) {
        mesh = original;
        break;
      }
      for (std::size_t i = 0; i < target.size(); ++i) target[i] = (target[i] + original.points_mm[i]) / 2;
    }
  }
  double largest = 0, squares = 0;
  for (std::size_t i = 0; i < mesh.points_mm.size(); ++i) {
    const double d = norm(mesh.points_mm[i] - original.points_mm[i]);
    largest = std::max(largest, d);
    squares += d * d;
  }
  with_field("smooth", [&] { require_valid(mesh, progress.part(0.9, 1)); });
  const double smoothed_volume = surface::volume_mm3(mesh);
  SmoothResult result;
  result.triangles_count = mesh.triangles.size();
  result.displacement_max_mm = largest;
  result.displacement_rms_mm = mesh.points_mm.empty() ? 0 : std::sqrt(squares / mesh.points_mm.size());
  result.strength_ratio = strength;
  result.volume_ml = smoothed_volume / 1000;
  result.volume_change_percent = 100 * (smoothed_volume / volume - 1);
  if (to_reference) result.reference_distance_max_mm = to_reference->largest_mm(mesh);
  if (bound_mm > 0) result.total_deviation_proven_mm = bound_mm;
  result.points_held_back_count = static_cast<std::int64_t>(std::count(held.begin(), held.end(), 1));
  progress.report(1);
  return {std::move(mesh), result, {}};
}

}  // namespace trephine::meshing
