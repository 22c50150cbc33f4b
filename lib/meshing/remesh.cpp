// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/remesh.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>

#include "base/error.h"
#include "base/memory_budget.h"
#include "base/refusal.h"
#include "base/text.h"
#include "meshing/remesh_child.h"
#include "meshing/validity.h"
#include "surface/incidence.h"
#include "surface/point_to_mesh.h"

namespace trephine::meshing {
namespace {

constexpr int tries = 5;

struct Edges {
  double least = 1e300, mean = 0, most = 0;

  explicit Edges(const surface::TriMesh& mesh) {
    std::size_t count = 0;
    surface::for_each_edge(mesh, surface::Incidence(mesh), [&](std::uint32_t p, auto from, auto) {
      const double l = norm(mesh.points_mm[p] - mesh.points_mm[from->other]);
      least = std::min(least, l);
      most = std::max(most, l);
      mean += l;
      ++count;
    });
    mean /= double(count);
  }
};

double reach_mm(const surface::TriMesh& from, const surface::PointToMesh& to, const Progress& progress) {
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < from.points_mm.size(); ++i) points.push_back(from.world_mm(i));
  for (const auto& t : from.triangles)
    points.push_back(from.origin_mm + (from.points_mm[t[0]] + from.points_mm[t[1]] + from.points_mm[t[2]]) / 3);
  return to.largest_distance_mm(points, 0, progress);
}

/// CGAL's remeshing crashes on some surfaces whose edges are much longer than asked for. It does not crash on the same
/// surfaces where their sharpest edges are kept.
surface::TriMesh evenly(const surface::TriMesh& mesh, double edge_mm, const RemeshParams& p, const Progress& progress) {
  using Clock = std::chrono::steady_clock;
  constexpr double sharpest_deg = 90;
  const auto start = Clock::now();
  try {
    return remesh_evenly(mesh, edge_mm, p.iterations_count, p.feature_angle_deg, p.time_limit_s, progress);
  } catch (const Error& e) {
    const double left_s = p.time_limit_s - std::chrono::duration<double>(Clock::now() - start).count();
    if (e.code() != ExitCode::internal || left_s <= 0 || p.feature_angle_deg <= sharpest_deg) throw;
    return remesh_evenly(mesh, edge_mm, p.iterations_count, sharpest_deg, left_s, progress);
  }
}

double mean_least_angle_deg(const surface::TriMesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles) {
    double least = M_PI;
    for (int c = 0; c < 3; ++c) {
      const Vec3 a = mesh.points_mm[t[(c + 1) % 3]] - mesh.points_mm[t[c]],
                 b = mesh.points_mm[t[(c + 2) % 3]] - mesh.points_mm[t[c]];
      least = std::min(least, std::atan2(norm(cross(a, b)), dot(a, b)));
    }
    sum += least;
  }
  return sum / double(mesh.triangles.size()) * 180 / M_PI;
}

}  // namespace

Outcome<surface::TriMesh, RemeshResult> remesh(const surface::TriMesh& input, const RemeshParams& params,
                                               const Progress& progress) {
  surface::check_mesh(input);
  surface::TriMesh original = input;
  original.normals.clear();
  snap_to_float32(original);
  with_field("remesh: input", [&] { require_valid(original, progress.part(0, 0.1)); });
  const double volume = surface::volume_mm3(original);
  const surface::PointToMesh to_original(original, progress);
  double edge = params.edge_mm > 0 ? params.edge_mm : Edges(original).mean;
  // Measured: 280 bytes a triangle in the child, and the result and its tree here.
  constexpr double bytes_per_triangle = 500;
  const double triangles = surface::area_mm2(original) / (0.43 * edge * edge);
  require_memory(static_cast<std::uint64_t>(std::min(triangles * bytes_per_triangle, 1e18)),
                 "remeshing to edges of " + to_text(edge) + " mm");
  std::string fault;
  for (int n = 1; n <= tries; ++n, edge *= 0.7) {
    surface::TriMesh mesh =
        with_field("remesh", [&] { return evenly(original, edge, params, progress.part(0.1, 0.7)); });
    snap_to_float32(mesh);
    const Validity v = check_validity(mesh, progress.part(0.7, 0.8));
    if (!v.valid()) {
      fault = v.text();
      continue;
    }
    const double deviation = std::max(reach_mm(mesh, to_original, progress),
                                      reach_mm(original, surface::PointToMesh(mesh, progress), progress.part(0.8, 1)));
    if (!(deviation <= params.max_deviation_mm)) {
      fault = "deviation " + to_text(deviation) + " mm, limit " + to_text(params.max_deviation_mm) + " mm";
      continue;
    }
    const Edges edges(mesh);
    const RemeshResult result{mesh.triangles.size(),
                              edge,
                              n,
                              deviation,
                              edges.least,
                              edges.mean,
                              edges.most,
                              mean_least_angle_deg(mesh),
                              100 * (v.volume_mm3 / volume - 1)};
    progress.report(1);
    return {std::move(mesh), result, {}};
  }
  throw refusal("remesh", fault + " with edges down to " + to_text(edge / 0.7) + " mm",
                {"choose a smaller `edge_mm`, or raise `max_deviation_mm`"});
}

}  // namespace trephine::meshing
