// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"
#include "mask/filters.h"
#include "trunk/canal_parts.h"

namespace trephine::trunk {
namespace {

constexpr int n = CanalWall::directions;
constexpr double escaped_mm = 1.0;  ///< a ray that goes so much farther than the wall around it has left the canal
constexpr double rim_mm = 0.3;      ///< the same beside a gap
constexpr double rim_reach_mm = 2;  ///< along the canal, the rim of bone beside a gap
constexpr double course_sigma_mm = 6;
constexpr int rounds = 3;  ///< of centring
constexpr int rejections = 10;
constexpr float none = -1;

struct Direction {
  double x, y;
};

const std::array<Direction, n>& directions() {
  static const std::array<Direction, n> table = [] {
    std::array<Direction, n> d;
    for (int a = 0; a < n; ++a) d[a] = {std::cos(2 * M_PI * a / n), std::sin(2 * M_PI * a / n)};
    return d;
  }();
  return table;
}

/// The distance at which the ray enters bone; `none` where it does not within reach.
float hit_mm(const grid::Field& bone, int k, CanalPoint from, Direction d, double reach_mm) {
  const Vec3 sp = bone.spacing_mm;
  const double step = 0.5 * std::min(sp.x, sp.y);
  const auto value = [&](double t, float& v) {
    const double x = from.i + d.x * t / sp.x, y = from.j + d.y * t / sp.y;
    if (!(x >= 0 && y >= 0 && x <= bone.size[0] - 1 && y <= bone.size[1] - 1)) return false;
    const int i = std::min(int(x), std::max(0, bone.size[0] - 2)), j = std::min(int(y), std::max(0, bone.size[1] - 2));
    const int i1 = std::min(i + 1, bone.size[0] - 1), j1 = std::min(j + 1, bone.size[1] - 1);
    const float u = float(x - i), w = float(y - j);
    const float a = bone.at(i, j, k) + u * (bone.at(i1, j, k) - bone.at(i, j, k));
    const float b = bone.at(i, j1, k) + u * (bone.at(i1, j1, k) - bone.at(i, j1, k));
    v = a + w * (b - a);
    return true;
  };
  float before = 0, v = 0;
  if (!value(0, before) || before > 0) return none;
  for (double t = step; t <= reach_mm; t += step) {
    if (!value(t, v)) return none;
    if (v > 0) return float(t - step * v / (v - before));
    before = v;
  }
  return none;
}

/// The median of those of `radii` that are known.
float middle(std::vector<float> radii, float otherwise) {
  radii.erase(std::remove(radii.begin(), radii.end(), none), radii.end());
  return mask::median(radii, otherwise);
}

/// The membrane through the hits: minimal sum of squared slopes, in mm over mm, and of distances to the hits that are
/// kept. Gauss-Seidel with over-relaxation, in place from the last solution.
void relax(std::vector<float>& radius, const std::vector<float>& hits, const std::vector<char>& kept, int slices,
           double dz_mm, double mean_mm, int iterations) {
  const double along = 1, around = std::pow(dz_mm / (mean_mm * 2 * M_PI / n), 2), hold = 3 * (along + around);
  for (int it = 0; it < iterations; ++it)
    for (int s = 0; s < slices; ++s)
      for (int a = 0; a < n; ++a) {
        const std::size_t v = std::size_t(s) * n + a;
        double sum = around * (radius[s * n + (a + 1) % n] + radius[s * n + (a + n - 1) % n]), weight = 2 * around;
        if (s > 0) sum += along * radius[v - n], weight += along;
        if (s + 1 < slices) sum += along * radius[v + n], weight += along;
        if (kept[v]) sum += hold * hits[v], weight += hold;
        radius[v] += float(1.7 * (sum / weight - radius[v]));
      }
}

/// Whether one of its neighbours is no hit, in the same slice or (where slices are thin) in the next one.
bool beside_gap(const std::vector<char>& near, std::size_t v, double dz_mm) {
  const std::size_t s = v / n, a = v % n;
  for (std::size_t d : {std::size_t(1), std::size_t(2)})
    if (!near[s * n + (a + d) % n] || !near[s * n + (a + n - d) % n]) return true;
  const std::size_t reach = std::size_t(rim_reach_mm / dz_mm);
  for (std::size_t d = 1; d <= reach; ++d)
    if ((v >= d * n && !near[v - d * n]) || (v + d * n < near.size() && !near[v + d * n])) return true;
  return false;
}

CanalWall wall_of(const grid::Field& bone, const CanalCourse& course, const CanalParams& p, const Progress& progress) {
  const int slices = int(course.points.size());
  std::vector<float> hits(std::size_t(slices) * n);
  parallel_for(0, slices, 4, [&](std::int64_t from, std::int64_t to) {
    progress.check();
    for (int s = int(from); s < to; ++s)
      for (int a = 0; a < n; ++a)
        hits[std::size_t(s) * n + a] =
            hit_mm(bone, course.first_slice + s, course.points[s], directions()[a], p.max_radius_mm);
  });
  // The iteration begins with the usual distance in that direction in the slices around.
  const int window = std::max(2, int(std::lround(15 / bone.spacing_mm.z)));
  const float usual = middle(hits, float(p.max_radius_mm / 2));
  std::vector<float> first(hits.size());
  for (int s = 0; s < slices; ++s)
    for (int a = 0; a < n; ++a) {
      std::vector<float> around;
      for (int t = std::max(0, s - window); t <= std::min(slices - 1, s + window); ++t)
        for (int b : {a + n - 2, a, a + 2}) around.push_back(hits[std::size_t(t) * n + b % n]);
      first[std::size_t(s) * n + a] = middle(around, usual);
    }
  CanalWall wall;
  wall.radius_mm = first;
  wall.is_bone.assign(hits.size(), 0);
  std::vector<char> near(hits.size());
  double limit_mm = 3 * escaped_mm;
  for (int r = 0; r < rejections; ++r) {
    progress.check();
    for (std::size_t v = 0; v < hits.size(); ++v) near[v] = hits[v] != none && hits[v] < wall.radius_mm[v] + limit_mm;
    // Beside a gap the bone's rim is round and blurred, and met too late: it must not say where the gap's wall begins.
    for (std::size_t v = 0; v < hits.size(); ++v)
      wall.is_bone[v] = near[v] && (hits[v] < wall.radius_mm[v] + rim_mm || !beside_gap(near, v, bone.spacing_mm.z));
    relax(wall.radius_mm, hits, wall.is_bone, slices, bone.spacing_mm.z, usual, r + 1 < rejections ? 60 : 200);
    limit_mm = std::max(escaped_mm, limit_mm * 0.6);
  }
  for (float& v : wall.radius_mm) v = std::max(v, 0.5f);
  return wall;
}

/// The points moved to the middle of their cross-sections, and smoothed along the canal.
void centre(CanalCourse& course, const CanalWall& wall, const grid::Lattice& l) {
  const int slices = int(course.points.size());
  std::vector<CanalPoint> moved = course.points;
  for (int s = 0; s < slices; ++s) {
    double area = 0, x = 0, y = 0;
    for (int a = 0; a < n; ++a) {
      const double r = wall.radius_mm[std::size_t(s) * n + a];
      area += r * r / 2;
      x += r * r * r / 3 * directions()[a].x;
      y += r * r * r / 3 * directions()[a].y;
    }
    moved[s].i += x / area / l.spacing_mm.x;
    moved[s].j += y / area / l.spacing_mm.y;
  }
  // A line through the points around, by how much of their wall is bone: over gaps the course goes straight on.
  const int reach = std::max(1, int(std::ceil(3 * course_sigma_mm / l.spacing_mm.z)));
  for (int s = 0; s < slices; ++s) {
    double w0 = 1e-9, w1 = 0, w2 = 0, i0 = 0, i1 = 0, j0 = 0, j1 = 0;
    for (int t = std::max(0, s - reach); t <= std::min(slices - 1, s + reach); ++t) {
      const double z = (t - s) * l.spacing_mm.z, u = z / course_sigma_mm, walled = wall.walled_ratio(std::size_t(t));
      const double w = std::exp(-u * u / 2) * (0.001 + walled * walled * walled);
      w0 += w, w1 += w * z, w2 += w * z * z;
      i0 += w * moved[t].i, i1 += w * z * moved[t].i;
      j0 += w * moved[t].j, j1 += w * z * moved[t].j;
    }
    const double turn = w0 * w2 - w1 * w1;
    if (turn > 1e-6 * w0 * w0)
      course.points[s] = {(w2 * i0 - w1 * i1) / turn, (w2 * j0 - w1 * j1) / turn};
    else
      course.points[s] = {i0 / w0, j0 / w0};
  }
}

}  // namespace

double CanalWall::area_mm2(std::size_t slice) const {
  double area = 0;
  for (int a = 0; a < n; ++a)
    area += 0.5 * std::sin(2 * M_PI / n) * radius_mm[slice * n + a] * radius_mm[slice * n + (a + 1) % n];
  return area;
}

double CanalWall::walled_ratio(std::size_t slice) const {
  return std::count(is_bone.begin() + slice * n, is_bone.begin() + (slice + 1) * n, 1) / double(n);
}

double CanalWall::at(std::size_t slice, double angle) const {
  const double a = (angle < 0 ? angle + 2 * M_PI : angle) * n / (2 * M_PI);
  const int low = std::min(int(a), n - 1);
  const float *r = &radius_mm[slice * n], from = r[low], to = r[(low + 1) % n];
  return from + (a - low) * (to - from);
}

CanalWall canal_wall(const grid::Field& bone, CanalCourse& course, const CanalParams& params,
                     const Progress& progress) {
  for (int round = 0; round < rounds; ++round) centre(course, wall_of(bone, course, params, progress), bone);
  return wall_of(bone, course, params, progress);
}

}  // namespace trephine::trunk
