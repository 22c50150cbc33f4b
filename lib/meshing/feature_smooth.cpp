// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/feature_smooth.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "surface/incidence.h"

namespace trephine::meshing {
namespace {

constexpr std::int64_t grain = 8192;
constexpr int fitting_steps = 20;
constexpr double at_rest = 1e-4;  // radians, about

struct Facets {
  std::vector<Vec3> normal, middle;
  std::vector<double> area;

  explicit Facets(const surface::TriMesh& mesh)
      : normal(mesh.triangles.size()), middle(mesh.triangles.size()), area(mesh.triangles.size()) {
    for (std::size_t t = 0; t < normal.size(); ++t) {
      const auto& v = mesh.triangles[t];
      const Vec3 twice = surface::triangle_normal(mesh, t);
      normal[t] = normalized(twice);
      area[t] = norm(twice) / 2;
      middle[t] = (mesh.points_mm[v[0]] + mesh.points_mm[v[1]] + mesh.points_mm[v[2]]) / 3;
    }
  }
};

/// The mean distance between the centres of neighbouring triangles.
double mean_step(const surface::TriMesh& mesh, const surface::Incidence& incidence, const Facets& facets) {
  double sum = 0;
  std::size_t count = 0;
  surface::for_each_edge(mesh, incidence, [&](std::uint32_t, auto from, auto to) {
    if (to - from != 2) return;
    sum += norm(facets.middle[from->triangle] - facets.middle[(from + 1)->triangle]);
    ++count;
  });
  return count > 0 ? sum / double(count) : 0;
}

}  // namespace

std::vector<Vec3> fit_to_filtered_normals(const surface::TriMesh& mesh, std::int64_t iterations,
                                          double feature_angle_deg, const Progress& progress) {
  const surface::Incidence incidence(mesh);
  Facets facets(mesh);
  const double reach = mean_step(mesh, incidence, facets);
  const double by_distance = reach > 0 ? 1 / (2 * reach * reach) : 0;
  const double turn = 2 * std::sin(feature_angle_deg * M_PI / 360);
  const double by_turn = 1 / (2 * turn * turn / 4);  // at the angle itself a neighbour counts exp(-2)
  const auto triangles = static_cast<std::int64_t>(mesh.triangles.size());
  const auto points = static_cast<std::int64_t>(mesh.points_mm.size());
  std::vector<Vec3> next(facets.normal.size());
  std::vector<double> largest(std::size_t((triangles + grain - 1) / grain));
  for (std::int64_t n = 0; n < iterations; ++n) {
    progress.report(0.9 * double(n) / double(iterations));
    parallel_for(0, triangles, grain, [&](std::int64_t from, std::int64_t to) {
      double most = 0;
      for (std::int64_t t = from; t < to; ++t) {
        const Vec3 own = facets.normal[t];
        Vec3 sum;
        for (const std::uint32_t v : mesh.triangles[t])
          for (std::uint32_t i = incidence.begin[v]; i < incidence.begin[v + 1]; ++i) {
            const std::uint32_t s = incidence.triangle[i];
            const Vec3 apart = facets.middle[s] - facets.middle[t], turned = facets.normal[s] - own;
            sum += facets.normal[s] *
                   (facets.area[s] * std::exp(-dot(apart, apart) * by_distance - dot(turned, turned) * by_turn));
          }
        next[t] = norm(sum) > 0 ? normalized(sum) : own;
        most = std::max(most, norm(next[t] - own));
      }
      largest[std::size_t(from / grain)] = most;
    });
    facets.normal.swap(next);
    if (*std::max_element(largest.begin(), largest.end()) < at_rest) break;
  }
  std::vector<Vec3> now = mesh.points_mm, moved(now.size());
  for (int step = 0; step < fitting_steps; ++step) {
    progress.check();
    parallel_for(0, points, grain, [&](std::int64_t from, std::int64_t to) {
      for (std::int64_t p = from; p < to; ++p) {
        Vec3 sum;
        for (std::uint32_t i = incidence.begin[p]; i < incidence.begin[p + 1]; ++i) {
          const std::uint32_t t = incidence.triangle[i];
          const auto& v = mesh.triangles[t];
          const Vec3 n = facets.normal[t], middle = (now[v[0]] + now[v[1]] + now[v[2]]) / 3;
          sum += n * dot(n, middle - now[p]);
        }
        const std::uint32_t around = incidence.begin[p + 1] - incidence.begin[p];
        moved[p] = around > 0 ? now[p] + sum / double(around) : now[p];
      }
    });
    now.swap(moved);
  }
  progress.report(1);
  return now;
}

}  // namespace trephine::meshing
