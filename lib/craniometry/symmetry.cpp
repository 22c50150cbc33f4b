// SPDX-License-Identifier: GPL-3.0-or-later
#include "craniometry/symmetry.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "craniometry/near_distance.h"
#include "grid/sample.h"
#include "mask/filters.h"
#include "surface/bounds.h"

namespace trephine::craniometry {
namespace {

constexpr int reach_voxels = 3;
constexpr double raster_mm = 2.5, cut_off_mm = 6, midline_reach_mm = 35, midline_sigma_mm = 14;

/// A shape's signed distance on the coarse raster, and points of its surface.
struct Shape {
  grid::Grid<float> distance;
  std::vector<Vec3> points;
};

grid::Lattice coarse_lattice(const grid::Lattice& field) {
  const auto [low, high] = surface::bounds_of(field);
  grid::Lattice l;
  l.spacing_mm = {raster_mm, raster_mm, raster_mm};
  l.origin_mm = low - Vec3{1, 1, 1} * (2 * raster_mm);
  for (int a = 0; a < 3; ++a) l.size[a] = int(std::min(400.0, std::ceil((high[a] - low[a]) / raster_mm) + 5));
  return l;
}

Shape make_shape(const FieldView& view, const Progress& progress) {
  grid::Field coarse(coarse_lattice(view.field()));
  parallel_for(0, coarse.size[2], 1, [&](std::int64_t from, std::int64_t to) {
    for (int k = int(from); k < to; ++k) {
      progress.check();
      for (int j = 0; j < coarse.size[1]; ++j)
        for (int i = 0; i < coarse.size[0]; ++i)
          // Otherwise bright bone beside soft tissue would push the surface outwards between the coarse voxels.
          coarse.at(i, j, k) =
              float(std::clamp(view(coarse.to_world_mm({double(i), double(j), double(k)})), -200.0, 200.0));
    }
  });
  Shape s;
  s.distance = near_distance_mm(coarse, reach_voxels);
  for (int k = 1; k + 1 < coarse.size[2]; ++k)
    for (int j = 1; j + 1 < coarse.size[1]; ++j)
      for (int i = 1; i + 1 < coarse.size[0]; ++i) {
        const float d = s.distance.at(i, j, k);
        if (!(std::abs(d) < 0.75 * raster_mm)) continue;
        const Vec3 g{double(s.distance.at(i + 1, j, k)) - s.distance.at(i - 1, j, k),
                     double(s.distance.at(i, j + 1, k)) - s.distance.at(i, j - 1, k),
                     double(s.distance.at(i, j, k + 1)) - s.distance.at(i, j, k - 1)};
        const Vec3 p = coarse.to_world_mm({double(i), double(j), double(k)}) - normalized(g) * d;
        // Where the scan cuts the head there is no surface.
        if (view.depth_in_scan_mm(p) > 3) s.points.push_back(p);
      }
  return s;
}

double sample(const grid::Grid<float>& g, Vec3 world) {
  return grid::sampled(g, (world - g.origin_mm) / raster_mm, grid::value_beyond(-cut_off_mm));
}

/// A plane near the sagittal one: normal (1, yaw, roll) made unit, its distance along it from the pivot.
using Pose = std::array<double, 3>;
Vec3 normal_of(const Pose& p) { return normalized(Vec3{1, p[0], p[1]}); }

class Mirror {
 public:
  Mirror(const FieldView& skin, const FieldView& skull, const Progress& progress)
      : scan_(skin), shapes_{make_shape(skull, progress.part(0, 0.4)), make_shape(skin, progress.part(0.4, 0.8))} {
    for (const Vec3 p : shapes_[0].points) pivot_ += p;
    pivot_ = pivot_ / std::max<double>(1, double(shapes_[0].points.size()));
  }
  Vec3 pivot() const { return pivot_; }
  std::size_t points() const { return shapes_[0].points.size(); }

  struct Score {
    double mean_mm = cut_off_mm, median_mm = cut_off_mm, matched = 0, scanned = 0;
  };
  /// Scores every `stride`-th point, of those within `reach_mm` of the plane.
  Score score(const Pose& pose, std::size_t stride, double reach_mm = 1e9, bool with_median = false) const {
    const Vec3 n = normal_of(pose);
    const double offset = dot(n, pivot_) + pose[2];
    double sum = 0;
    std::size_t count = 0, all = 0, matched = 0;
    std::vector<float> residuals;
    for (const Shape& s : shapes_)
      for (std::size_t i = 0; i < s.points.size(); i += stride) {
        const Vec3 p = s.points[i];
        const double side = dot(n, p) - offset;
        if (std::abs(side) > reach_mm) continue;
        ++all;
        const Vec3 q = p - n * (2 * side);
        if (scan_.depth_in_scan_mm(q) < 0) continue;
        const double r = std::min(std::abs(sample(s.distance, q)), cut_off_mm);
        sum += r;
        ++count;
        matched += r < 4;
        if (with_median) residuals.push_back(float(r));
      }
    Score out;
    out.scanned = all ? double(count) / all : 0;
    if (!count) return out;
    // Where little of the mirror image was scanned, the mean is less reliable.
    out.mean_mm = sum / count + 3 * std::max(0.0, 0.7 - out.scanned);
    out.matched = double(matched) / count;
    if (with_median) out.median_mm = mask::median(residuals, float(cut_off_mm));
    return out;
  }

  /// One step of robust Gauss-Newton on the points near the plane; returns how far it moved, mm or thousandths.
  double refine_midline(Pose& pose) const {
    const std::array<double, 3> delta{1e-3, 1e-3, 0.1};
    double a[3][3] = {}, b[3] = {};
    const Vec3 n0 = normal_of(pose);
    const double offset0 = dot(n0, pivot_) + pose[2];
    for (const Shape& s : shapes_)
      for (const Vec3 p : s.points) {
        const double side = dot(n0, p) - offset0;
        if (std::abs(side) > midline_reach_mm || scan_.depth_in_scan_mm(p - n0 * (2 * side)) < 3) continue;
        const auto residual = [&](const Pose& at) {
          const Vec3 n = normal_of(at);
          return sample(s.distance, p - n * (2 * (dot(n, p) - dot(n, pivot_) - at[2])));
        };
        const double r = residual(pose);
        if (std::abs(r) > cut_off_mm) continue;
        double weight = std::exp(-0.5 * (side / midline_sigma_mm) * (side / midline_sigma_mm));
        weight *= 1 / (1 + (r / 1.5) * (r / 1.5));
        double g[3];
        for (int k = 0; k < 3; ++k) {
          Pose up = pose, down = pose;
          up[k] += delta[k], down[k] -= delta[k];
          g[k] = (residual(up) - residual(down)) / (2 * delta[k]);
        }
        for (int i = 0; i < 3; ++i) {
          b[i] += weight * g[i] * r;
          for (int j = 0; j < 3; ++j) a[i][j] += weight * g[i] * g[j];
        }
      }
    // A weak pull to the present pose, because smooth bone constrains nothing.
    a[0][0] += 1e3, a[1][1] += 1e3, a[2][2] += 1;
    const Vec3 c0{a[0][0], a[1][0], a[2][0]}, c1{a[0][1], a[1][1], a[2][1]}, c2{a[0][2], a[1][2], a[2][2]};
    const Vec3 rhs{b[0], b[1], b[2]};
    const double det = dot(c0, cross(c1, c2));
    if (!(std::abs(det) > 0)) return 0;
    Vec3 step{dot(rhs, cross(c1, c2)) / det, dot(c0, cross(rhs, c2)) / det, dot(c0, cross(c1, rhs)) / det};
    step.x = std::clamp(step.x, -0.02, 0.02), step.y = std::clamp(step.y, -0.02, 0.02),
    step.z = std::clamp(step.z, -2.0, 2.0);
    pose = {pose[0] - step.x, pose[1] - step.y, pose[2] - step.z};
    return std::max({std::abs(step.x) * 100, std::abs(step.y) * 100, std::abs(step.z)});
  }

 private:
  const FieldView& scan_;
  std::array<Shape, 2> shapes_;
  Vec3 pivot_;
};

/// The best of a raster of poses, then of ever finer steps about it.
Pose search(const Mirror& mirror, const Progress& progress) {
  const std::size_t stride = std::max<std::size_t>(1, mirror.points() / 1200);
  std::vector<Pose> poses;
  for (int yaw = -5; yaw <= 5; ++yaw)
    for (int roll = -5; roll <= 5; ++roll)
      for (int offset = -4; offset <= 4; ++offset) poses.push_back({yaw * 0.1, roll * 0.1, offset * 6.0});
  std::vector<double> scores(poses.size());
  parallel_for(0, std::int64_t(poses.size()), 16, [&](std::int64_t from, std::int64_t to) {
    progress.check();
    for (std::int64_t i = from; i < to; ++i) scores[i] = mirror.score(poses[i], stride).mean_mm;
  });
  std::vector<std::size_t> order(poses.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return scores[a] < scores[b]; });
  Pose best = poses[order[0]];
  double least = std::numeric_limits<double>::infinity();
  for (int start = 0; start < 4; ++start) {
    Pose pose = poses[order[start]];
    double here = mirror.score(pose, stride).mean_mm;
    for (double scale = 0.5; scale > 0.02;) {
      bool moved = false;
      for (int axis = 0; axis < 3; ++axis)
        for (double sign : {-1.0, 1.0}) {
          Pose next = pose;
          next[axis] += sign * scale * (axis < 2 ? 0.1 : 6.0);
          const double there = mirror.score(next, stride).mean_mm;
          if (there < here - 1e-6) pose = next, here = there, moved = true;
        }
      if (!moved) scale /= 2;
    }
    if (here < least) least = here, best = pose;
  }
  return best;
}

}  // namespace

MirrorPlane find_mirror_plane(const FieldView& skin, const FieldView& skull, const Progress& progress) {
  const Mirror mirror(skin, skull, progress);
  MirrorPlane plane;
  plane.point_mm = mirror.pivot();
  if (mirror.points() < 500) return plane;
  Pose pose = search(mirror, progress.part(0.8, 1));
  const Mirror::Score whole = mirror.score(pose, 2, 1e9, true);
  // How much worse the neighbouring planes are: this tells whether it is the plane or one of many.
  plane.rise_mm = cut_off_mm;
  for (int axis = 0; axis < 3; ++axis)
    for (double sign : {-1.0, 1.0}) {
      Pose off = pose;
      off[axis] += sign * (axis < 2 ? 0.105 : 8);
      plane.rise_mm = std::min(plane.rise_mm, mirror.score(off, 4).mean_mm - whole.mean_mm);
    }
  for (int i = 0; i < 30 && mirror.refine_midline(pose) > 0.01; ++i) progress.check();
  const Vec3 n = normal_of(pose);
  plane.normal = n;
  plane.point_mm = mirror.pivot() + n * pose[2];
  plane.residual_mm = whole.median_mm;
  plane.midline_mm = mirror.score(pose, 1, midline_reach_mm, true).median_mm;
  plane.matched = whole.matched;
  plane.scanned = whole.scanned;
  plane.confidence = std::min(
      {mask::ramp(plane.residual_mm, 4, 1), mask::ramp(plane.matched, 0.5, 0.9), mask::ramp(plane.rise_mm, 0.1, 0.6)});
  return plane;
}

}  // namespace trephine::craniometry
