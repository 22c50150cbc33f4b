// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/deviation.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include "base/error.h"
#include "base/parallel.h"
#include "base/rank.h"
#include "base/result.h"
#include "base/splitmix64.h"
#include "surface/point_to_mesh.h"

namespace trephine::metrics {
namespace {

constexpr std::int64_t piece = 2048;

// Number `which` of sample i, in [0, 1).
double hashed(std::uint64_t i, std::uint64_t which) {
  return unit_of_bits(splitmix64_mixed((4 * i + which + 1) * splitmix64_step));
}

std::vector<Vec3> used_points(const surface::TriMesh& mesh) {
  std::vector<bool> used(mesh.points_mm.size());
  for (const auto& t : mesh.triangles)
    for (const std::uint32_t v : t) used[v] = true;
  std::vector<Vec3> points;
  points.reserve(mesh.points_mm.size());
  for (std::size_t i = 0; i < used.size(); ++i)
    if (used[i]) points.push_back(mesh.world_mm(i));
  return points;
}

// Statistics of signed distances, which are moved from. `vertex_max_mm` only counts for the maximum.
DeviationStats stats_of(std::vector<double> signed_mm, double vertex_max_mm) {
  DeviationStats s;
  s.samples = signed_mm.size();
  s.max_mm = vertex_max_mm;
  if (signed_mm.empty()) return s;
  double sum = 0, absolute = 0, squares = 0;
  for (double& d : signed_mm) {
    sum += d;
    squares += d * d;
    d = std::abs(d);
    absolute += d;
  }
  const auto n = double(s.samples);
  s.bias_mm = sum / n;
  s.mean_mm = absolute / n;
  s.rms_mm = std::sqrt(squares / n);
  s.p99_mm = value_at_rank(signed_mm, std::size_t((s.samples * 99 + 99) / 100 - 1));  // ceil(0.99 n), at least 1
  s.max_mm = std::max(s.max_mm, *std::max_element(signed_mm.begin(), signed_mm.end()));
  return s;
}

double largest(const std::vector<double>& d) {
  double m = 0;
  for (const double v : d) m = std::max(m, std::abs(v));
  return m;
}

struct Side {
  std::vector<double> signed_mm;
  double vertex_max_mm = 0;
};

std::vector<Vec3> kept(std::vector<Vec3> points, const KnownRegion& within) {
  if (within)
    points.erase(std::remove_if(points.begin(), points.end(), [&](Vec3 p) { return !within(p); }), points.end());
  return points;
}

// The distances from sample points and vertices of `from` to `to`.
Side measure_side(const surface::TriMesh& from, const surface::PointToMesh& to, const DeviationParams& params,
                  const KnownRegion& within, const Progress& progress) {
  Side side;
  side.signed_mm =
      to.signed_distances_mm(kept(points_on_surface(from, std::size_t(params.sample_count)), within), progress);
  progress.report(0.7);
  if (params.at_vertices)
    side.vertex_max_mm = to.largest_distance_mm(kept(used_points(from), within), largest(side.signed_mm), progress);
  progress.report(1);
  return side;
}

std::vector<double> evaluate(const surface::DistanceFunction& truth, const std::vector<Vec3>& points,
                             const Progress& progress) {
  std::vector<double> d(points.size());
  parallel_for(0, std::int64_t(points.size()), piece, [&](std::int64_t from, std::int64_t to) {
    progress.check();
    for (std::int64_t i = from; i < to; ++i) {
      d[i] = truth(points[i]);
      if (!std::isfinite(d[i]))
        throw Error(ExitCode::internal, "", "truth", "the distance function gave no finite number");
    }
  });
  return d;
}

Deviation combine(Side mesh_to_reference, Side reference_to_mesh) {
  for (double& d : reference_to_mesh.signed_mm) d = -d;  // a reference outside of the mesh: the mesh lies inside
  std::vector<double> both = mesh_to_reference.signed_mm;
  both.insert(both.end(), reference_to_mesh.signed_mm.begin(), reference_to_mesh.signed_mm.end());
  const double vertex_max = std::max(mesh_to_reference.vertex_max_mm, reference_to_mesh.vertex_max_mm);
  Deviation d;
  d.mesh_to_reference = stats_of(std::move(mesh_to_reference.signed_mm), mesh_to_reference.vertex_max_mm);
  d.reference_to_mesh = stats_of(std::move(reference_to_mesh.signed_mm), reference_to_mesh.vertex_max_mm);
  d.both = stats_of(std::move(both), vertex_max);
  d.samples_count = d.both.samples;
  return d;
}

void check_surface(const surface::TriMesh& mesh, const char* which) {
  with_field(which, [&] {
    surface::check_mesh(mesh);
    if (mesh.triangles.empty()) throw Error(ExitCode::bad_input, "", "", "has no triangles");
  });
}

}  // namespace

std::vector<Vec3> points_on_surface(const surface::TriMesh& mesh, std::size_t count) {
  std::vector<Vec3> points;
  if (count == 0) return points;
  double total = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) total += norm(surface::triangle_normal(mesh, t));
  if (!(total > 0) || !std::isfinite(total))
    throw Error(ExitCode::bad_input, "", "surface", "has no area to measure on");
  points.reserve(count);
  const double step = total / double(count);
  double before = 0;  // area of the triangles before t
  std::size_t t = 0;
  double own = norm(surface::triangle_normal(mesh, 0));
  for (std::size_t i = 0; i < count; ++i) {
    const double target = (double(i) + hashed(i, 0)) * step;
    while (target >= before + own && t + 1 < mesh.triangles.size()) {
      before += own;
      own = norm(surface::triangle_normal(mesh, ++t));
    }
    const auto& v = mesh.triangles[t];
    const double r = std::sqrt(hashed(i, 1)), s = hashed(i, 2);
    points.push_back(mesh.origin_mm + (mesh.points_mm[v[0]] * (1 - r) + mesh.points_mm[v[1]] * (r * (1 - s)) +
                                       mesh.points_mm[v[2]] * (r * s)));
  }
  return points;
}

Deviation measure_deviation(const surface::TriMesh& mesh, const surface::TriMesh& reference,
                            const DeviationParams& params, const Progress& progress) {
  check_surface(mesh, "surface");
  check_surface(reference, "reference");
  Side forth, back;
  parallel_do(
      {[&] {
         const surface::PointToMesh to_reference(reference, progress);
         progress.report(0.3);
         forth = measure_side(mesh, to_reference, params, {}, progress.part(0.3, 1));
       },
       [&] { back = measure_side(reference, surface::PointToMesh(mesh, progress), params, {}, progress.part(0, 0)); }});
  return combine(std::move(forth), std::move(back));
}

Deviation measure_deviation_to_truth(const surface::TriMesh& mesh, const surface::DistanceFunction& truth,
                                     const surface::TriMesh& truth_mesh, const DeviationParams& params,
                                     const KnownRegion& within, const Progress& progress) {
  check_surface(mesh, "surface");
  check_surface(truth_mesh, "truth");
  Side forth;
  const auto samples = std::size_t(params.sample_count);
  forth.signed_mm = evaluate(truth, kept(points_on_surface(mesh, samples), within), progress);
  progress.report(0.3);
  if (params.at_vertices) forth.vertex_max_mm = largest(evaluate(truth, kept(used_points(mesh), within), progress));
  progress.report(0.5);
  const surface::PointToMesh to_mesh(mesh, progress);
  progress.report(0.7);
  Side back = measure_side(truth_mesh, to_mesh, params, within, progress.part(0.7, 1));
  if (forth.signed_mm.empty() || back.signed_mm.empty())
    throw Error(ExitCode::bad_input, "", "truth", "no point of the surface lies where the truth is known");
  return combine(std::move(forth), std::move(back));
}

}  // namespace trephine::metrics
