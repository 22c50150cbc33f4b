// SPDX-License-Identifier: GPL-3.0-or-later
#include "print/measure_parts.h"

#include <algorithm>

#include "base/parallel.h"
#include "surface/point_to_mesh.h"
#include "surface/vertex_normals.h"

namespace trephine::print {
namespace {

constexpr std::int64_t grain = 2048;
constexpr double first_mm = 0.3, last_step_mm = 0.02;  ///< where the climb begins, and how fine it ends

// The radius of the largest ball that is found for a corner; the search ends where it reaches `enough_mm`.
double ball_at(const surface::PointToMesh& distance, Vec3 p, Vec3 inwards, double enough_mm, double touch_mm) {
  const auto radius = [&](Vec3 c) { return -distance.signed_distance_mm(c); };
  if (radius(p + inwards * enough_mm) >= enough_mm - touch_mm / 4) return enough_mm;
  static const std::vector<Vec3> ways = [] {
    std::vector<Vec3> all;
    for (int x = -1; x <= 1; ++x)
      for (int y = -1; y <= 1; ++y)
        for (int z = -1; z <= 1; ++z)
          if (x != 0 || y != 0 || z != 0) all.push_back(normalized(Vec3{double(x), double(y), double(z)}));
    return all;
  }();
  Vec3 c = p + inwards * first_mm;
  double r = radius(c);
  for (double step = first_mm; step >= last_step_mm && r < enough_mm;) {
    Vec3 best = c;
    double widest = r;
    const auto offer = [&](Vec3 next) {
      const double now = radius(next);
      if (now > widest && norm(next - p) <= now + touch_mm) widest = now, best = next;
    };
    offer(c + inwards * step);
    if (widest <= r + 0.3 * step)
      for (const Vec3& way : ways) offer(c + way * step);
    if (widest > r)
      c = best, r = widest;
    else
      step *= 0.5;
  }
  return std::max(0.0, r);
}

}  // namespace

double smallest_wall_mm(const surface::TriMesh& mesh, const WallMeasure& how, const Progress& progress) {
  const surface::PointToMesh distance(mesh);
  const std::vector<Vec3> normals = surface::vertex_normals(mesh);
  const std::size_t count = mesh.points_mm.size();
  std::vector<double> least((count + grain - 1) / grain, how.up_to_mm / 2);
  parallel_for(0, std::int64_t(count), grain, [&](std::int64_t from, std::int64_t to) {
    progress.check();
    double& smallest = least[std::size_t(from / grain)];
    for (std::int64_t n = from; n < to; ++n) {
      if (mesh.world_mm(std::size_t(n)).z < how.from_z_mm) continue;
      smallest = std::min(smallest, ball_at(distance, mesh.world_mm(std::size_t(n)),
                                            -normalized(normals[std::size_t(n)]), smallest, how.touch_mm));
    }
  });
  return 2 * *std::min_element(least.begin(), least.end());
}

double smallest_gap_mm(const surface::TriMesh& a, const surface::TriMesh& b, double far_mm, const Progress& progress) {
  double least = far_mm;
  const auto from = [&](const surface::TriMesh& one, const surface::TriMesh& other) {
    const surface::Bounds box = surface::bounds_of(other);
    std::vector<Vec3> near;
    for (std::size_t n = 0; n < one.points_mm.size(); ++n) {
      const Vec3 p = one.world_mm(n);
      bool beside = true;
      for (int axis = 0; axis < 3; ++axis)
        beside = beside && p[axis] > box.min_mm[axis] - far_mm && p[axis] < box.max_mm[axis] + far_mm;
      if (beside) near.push_back(p);
    }
    if (near.empty()) return;
    for (const double d : surface::PointToMesh(other).signed_distances_mm(near, progress)) least = std::min(least, d);
  };
  from(a, b);
  from(b, a);
  return least;
}

}  // namespace trephine::print
