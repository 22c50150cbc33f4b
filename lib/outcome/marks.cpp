// SPDX-License-Identifier: GPL-3.0-or-later
#include "outcome/marks.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "base/pi.h"
#include "mask/filters.h"

namespace trephine::outcome {
namespace {

constexpr float edge_hu = -400;          ///< between air and what is printed
constexpr double steep_hu_per_mm = 120;  ///< of an edge that votes
constexpr double cell_mm = 1;
constexpr double least_votes_ratio = 0.2;  ///< of the votes that a whole sphere would give
constexpr std::size_t most_candidates = 60;
constexpr int directions = 240, rounds = 8;
constexpr double ray_step_mm = 0.2, beyond_mm = 2.5, near_mm = 1.6;
constexpr double least_share = 0.55, most_rms_mm = 0.35, radius_off_mm = 0.9;

Vec3 direction(int n) {  // evenly over the sphere, along a spiral
  const double z = 1 - 2 * (n + 0.5) / directions, r = std::sqrt(1 - z * z), turn = pi * (3 - std::sqrt(5.0)) * n;
  return {r * std::cos(turn), r * std::sin(turn), z};
}

// The place along a ray where the scan drops to half of what lies before it and air.
bool edge_on_ray(const ScanView& scan, Vec3 from, Vec3 way, double radius_mm, double& at_mm) {
  double before = scan(from), most = before, best = 1e9;
  const double half_of_inside = 0.5 * (std::max(before, double(edge_hu)) - 1000);
  const double level = std::clamp(half_of_inside, -700.0, 800.0);
  for (double d = ray_step_mm; d <= radius_mm + beyond_mm; d += ray_step_mm) {
    const double now = scan(from + way * d);
    if (now <= ScanView::beyond_hu / 2) return false;
    most = std::max(most, now);
    if (before >= level && now < level) {
      const double at = d - ray_step_mm * (now == before ? 0 : (level - now) / (before - now));
      if (std::abs(at - radius_mm) < std::abs(best - radius_mm)) best = at;
    }
    before = now;
  }
  at_mm = best;
  return std::abs(best - radius_mm) < near_mm + 1;
}

bool fitted(const ScanView& scan, double radius_mm, FoundSphere& s) {
  s.radius_mm = radius_mm;
  for (int round = 0; round < rounds; ++round) {
    std::vector<Vec3> on;
    for (int n = 0; n < directions; ++n) {
      const Vec3 way = direction(n);
      double at = 0;
      if (edge_on_ray(scan, s.at_mm, way, s.radius_mm, at)) on.push_back(way * at);
    }
    if (double(on.size()) < 0.3 * directions) return false;
    std::vector<float> off;
    off.reserve(on.size());
    for (const Vec3& p : on) off.push_back(float(std::abs(norm(p) - s.radius_mm)));
    std::vector<float> sorted = off;
    const double scale = std::max(0.1, 1.4826 * double(mask::median(sorted, 1)));
    Eigen::Matrix4d a = Eigen::Matrix4d::Zero();
    Eigen::Vector4d b = Eigen::Vector4d::Zero();
    double squares = 0, weights = 0;
    int inliers = 0;
    for (std::size_t n = 0; n < on.size(); ++n) {
      const double u = double(off[n]) / (4 * scale), w = u < 1 ? (1 - u * u) * (1 - u * u) : 0;
      const double r = norm(on[n]);
      const Vec3 way = on[n] * (1 / std::max(1e-9, r));
      const Eigen::Vector4d j(way.x, way.y, way.z, 1);
      a += w * j * j.transpose();
      b += w * (r - s.radius_mm) * j;
      squares += w * (r - s.radius_mm) * (r - s.radius_mm);
      weights += w;
      inliers += double(off[n]) < 0.6;
    }
    a.diagonal().array() += 1e-6;
    const Eigen::Vector4d x = a.ldlt().solve(b);
    s.at_mm += Vec3{x[0], x[1], x[2]};
    s.radius_mm = std::clamp(s.radius_mm + x[3], radius_mm - 1.5, radius_mm + 1.5);
    s.rms_mm = std::sqrt(squares / std::max(1e-9, weights));
    s.share = double(inliers) / directions;
  }
  return s.share >= least_share && s.rms_mm <= most_rms_mm && std::abs(s.radius_mm - radius_mm) <= radius_off_mm;
}

}  // namespace

std::vector<FoundSphere> find_spheres(const ScanView& scan, double radius_mm, const Progress& progress) {
  const grid::Lattice& l = scan.lattice();
  const mask::HuView& hu = scan.voxels();
  // Cells of votes, axes of the world.
  Vec3 low{1e9, 1e9, 1e9}, high{-1e9, -1e9, -1e9};
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 p = l.to_world_mm(
        {corner & 1 ? l.size[0] - 1.0 : 0, corner & 2 ? l.size[1] - 1.0 : 0, corner & 4 ? l.size[2] - 1.0 : 0});
    for (int a = 0; a < 3; ++a) low[a] = std::min(low[a], p[a]), high[a] = std::max(high[a], p[a]);
  }
  grid::Lattice cells;
  cells.spacing_mm = {cell_mm, cell_mm, cell_mm};
  cells.origin_mm = low;
  for (int a = 0; a < 3; ++a) cells.size[std::size_t(a)] = std::max(2, int((high[a] - low[a]) / cell_mm) + 2);
  grid::Grid<float> votes(cells);
  const double face_mm2 = std::cbrt(l.voxel_volume_mm3()) * std::cbrt(l.voxel_volume_mm3());
  for (int k = 1; k + 1 < l.size[2]; ++k) {
    progress.report(0.6 * k / l.size[2]);
    for (int j = 1; j + 1 < l.size[1]; ++j)
      for (int i = 1; i + 1 < l.size[0]; ++i) {
        if (hu(i, j, k) < edge_hu) continue;
        if (hu(i - 1, j, k) >= edge_hu && hu(i + 1, j, k) >= edge_hu && hu(i, j - 1, k) >= edge_hu &&
            hu(i, j + 1, k) >= edge_hu && hu(i, j, k - 1) >= edge_hu && hu(i, j, k + 1) >= edge_hu)
          continue;
        const Vec3 g{(hu(i + 1, j, k) - hu(i - 1, j, k)) / (2 * l.spacing_mm.x),
                     (hu(i, j + 1, k) - hu(i, j - 1, k)) / (2 * l.spacing_mm.y),
                     (hu(i, j, k + 1) - hu(i, j, k - 1)) / (2 * l.spacing_mm.z)};
        if (norm(g) < steep_hu_per_mm) continue;
        const Vec3 in = normalized(l.direction * g);
        const Vec3 at = cells.to_index(l.to_world_mm({double(i), double(j), double(k)}) + in * (radius_mm - 0.4));
        const int x = int(std::lround(at.x)), y = int(std::lround(at.y)), z = int(std::lround(at.z));
        if (cells.contains(x, y, z)) votes.at(x, y, z) += float(face_mm2);
      }
  }
  mask::gaussian(votes, 1.2);
  const double whole = 4 * pi * radius_mm * radius_mm / (std::pow(2 * pi, 1.5) * 1.2 * 1.2 * 1.2);
  std::vector<std::pair<float, Vec3>> peaks;
  for (int k = 1; k + 1 < cells.size[2]; ++k)
    for (int j = 1; j + 1 < cells.size[1]; ++j)
      for (int i = 1; i + 1 < cells.size[0]; ++i) {
        const float v = votes.at(i, j, k);
        if (double(v) < least_votes_ratio * whole) continue;
        bool top = true;
        for (int n = 0; n < 27 && top; ++n)
          top = n == 13 || votes.at(i + n % 3 - 1, j + n / 3 % 3 - 1, k + n / 9 - 1) <= v;
        if (top) peaks.emplace_back(v, cells.to_world_mm({double(i), double(j), double(k)}));
      }
  std::stable_sort(peaks.begin(), peaks.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  if (peaks.size() > most_candidates) peaks.resize(most_candidates);
  std::vector<FoundSphere> found;
  for (const auto& [v, at] : peaks) {
    progress.check();
    FoundSphere s;
    s.at_mm = at;
    if (!fitted(scan, radius_mm, s)) continue;
    if (std::none_of(found.begin(), found.end(),
                     [&](const FoundSphere& f) { return norm(f.at_mm - s.at_mm) < radius_mm; }))
      found.push_back(s);
  }
  progress.report(1);
  return found;
}

MarkFit fit_marks(const std::vector<print::PrintMark>& marks, const std::vector<FoundSphere>& spheres) {
  std::vector<Vec3> found;
  for (const FoundSphere& s : spheres) found.push_back(s.at_mm);
  return lesson::match_marks(marks, found);
}

}  // namespace trephine::outcome
