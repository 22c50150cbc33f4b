// SPDX-License-Identifier: GPL-3.0-or-later
#include "outcome/bone_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "base/degree.h"
#include "mask/coarse.h"
#include "mask/filters.h"

namespace trephine::outcome {
namespace {

constexpr double metal_hu = 2600;  ///< an edge beside it is not known
constexpr double air_hu = -500;
constexpr double coarse_mm = 3;         ///< cells of the map of distances
constexpr double far_mm = 9;            ///< distances count at most so much on it
constexpr double least_overlap = 0.25;  ///< of the points, within the scan
constexpr std::size_t coarse_points = 1500;
constexpr int coarse_rounds = 40;
constexpr double cap_mm = 2, step_mm = 0.25;
constexpr double nearest_share = 0.8;
constexpr double least_scale_mm = 0.08;  ///< of Tukey's weights: below it edges are as good as they can be
constexpr double radii_mm[] = {8, 6, 4, 3, 2.5, 2, 2, 2, 2, 2};

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector7 = Eigen::Matrix<double, 7, 1>;
using Matrix7 = Eigen::Matrix<double, 7, 7>;

itk::LinearMap rotated(Vec3 turn, Vec3 shift_mm, Vec3 centre_mm) {  // turn: axis times angle
  const double angle = norm(turn);
  Mat3 m;
  if (angle > 1e-12) {
    const Vec3 u = turn * (1 / angle);
    for (int a = 0; a < 3; ++a) {
      Vec3 e;
      e[a] = 1;
      m.column[a] = e * std::cos(angle) + cross(u, e) * std::sin(angle) + u * (dot(u, e) * (1 - std::cos(angle)));
    }
  }
  return {m, centre_mm - m * centre_mm + shift_mm};
}

Vec3 centroid(const std::vector<BonePoint>& points) {
  Vec3 sum;
  for (const BonePoint& p : points) sum += p.at_mm;
  return sum * (1.0 / double(std::max<std::size_t>(1, points.size())));
}

/// Distances to the scan's bone on coarse cells.
struct DistanceMap {
  grid::Grid<float> mm;
  Vec3 middle_mm;  ///< of the bone
  explicit DistanceMap(const ScanView& scan, const Progress& progress) {
    const mask::CoarseRaster raster = mask::coarse_raster(scan.lattice(), coarse_mm);
    const mask::BitMask bone = mask::coarse_mask(mask::above(scan.voxels(), float(scan.bone_hu())), raster, 0.25);
    middle_mm = bone.centre_mm();
    mm = mask::distance_mm(bone, progress);
  }
  double at(Vec3 p, Vec3& slope) const {
    const grid::Lattice& l = mm;
    const auto value = [&](Vec3 q) { return grid::sampled(mm, l.to_index(q), grid::value_beyond(-1)); };
    const double d = value(p);
    if (d < 0) return d;
    slope = {};
    for (int a = 0; a < 3; ++a) {
      Vec3 e;
      e[a] = 1.5;
      const double after = value(p + e), before = value(p - e);
      if (after >= 0 && before >= 0) slope[a] = (after - before) / 3;
    }
    return d;
  }
};

struct Placed {
  itk::LinearMap map;
  double cost = 1e9;
};

// Gauss-Newton on the distances, far ones counting less.
Placed descended(const std::vector<BonePoint>& points, const DistanceMap& distances, itk::LinearMap map) {
  Placed out{map, 1e9};
  for (int round = 0; round <= coarse_rounds; ++round) {
    Matrix6 a = Matrix6::Zero();
    Vector6 b = Vector6::Zero();
    double cost = 0;
    std::size_t within = 0;
    const Vec3 centre = map(centroid(points));
    for (const BonePoint& point : points) {
      const Vec3 p = map(point.at_mm);
      Vec3 slope;
      const double d = distances.at(p, slope);
      if (d < 0) {
        cost += 0.6 * far_mm;
        continue;
      }
      ++within;
      cost += std::min(d, far_mm);
      const double w = 1 / (1 + (d / 6) * (d / 6));
      const Vec3 turn = cross(p - centre, slope);
      Vector6 j;
      j << slope.x, slope.y, slope.z, turn.x, turn.y, turn.z;
      a += w * j * j.transpose();
      b -= w * d * j;
    }
    if (double(within) < least_overlap * double(points.size())) return out;
    cost /= double(points.size());
    if (cost < out.cost) out = {map, cost};
    a.diagonal().array() += 1e-3 * (1 + a.diagonal().array());
    const Vector6 x = a.ldlt().solve(b);
    Vec3 turn{x[3], x[4], x[5]}, shift{x[0], x[1], x[2]};
    if (norm(turn) > 6 * degree) turn = turn * (6 * degree / norm(turn));
    if (norm(shift) > 15) shift = shift * (15 / norm(shift));
    map = itk::then(map, rotated(turn, shift, centre));
    if (norm(turn) < 2e-4 && norm(shift) < 0.01) break;
  }
  return out;
}

/// Where the scan's bone ends along a point's normal, from the point.
enum class Edge { beyond, none, found };
Edge edge_along(const ScanView& scan, Vec3 p, Vec3 out, double radius_mm, double& off_mm) {
  const int steps = int(std::lround(radius_mm / step_mm));
  const double bone_hu = scan.bone_hu();
  double best = 1e9, before = scan(p - out * (steps * step_mm)), most = before;
  if (before <= ScanView::beyond_hu / 2) return Edge::beyond;
  for (int n = -steps + 1; n <= steps; ++n) {
    const double now = scan(p + out * (n * step_mm));
    if (now <= ScanView::beyond_hu / 2) return Edge::beyond;
    if (before >= bone_hu && now < bone_hu) {
      const double at = (n - 1 + (before - bone_hu) / (before - now)) * step_mm;
      if (std::abs(at) < std::abs(best)) best = at;
    }
    before = now;
    most = std::max(most, now);
  }
  if (most > metal_hu || most < air_hu) return Edge::beyond;  // what no slice covers is read as air
  if (best > 1e8) return Edge::none;
  off_mm = best;
  return Edge::found;
}

struct Matched {
  Vec3 p, out;
  double off_mm;
};
struct Matches {
  std::vector<Matched> list;
  std::size_t within = 0;
};
Matches matches_of(const std::vector<BonePoint>& points, const ScanView& scan, const itk::LinearMap& map,
                   double radius_mm) {
  Matches m;
  for (const BonePoint& point : points) {
    const Vec3 p = map(point.at_mm), out = map.matrix * point.out;
    double off = 0;
    const Edge edge = edge_along(scan, p, out, radius_mm, off);
    if (edge == Edge::beyond) continue;
    ++m.within;
    if (edge == Edge::found) m.list.push_back({p, out, off});
  }
  return m;
}

/// How much wider all bone is in the scan than in the case: its blur and its edge are others.
double widening_of(const std::vector<Matched>& list) {
  std::vector<float> off;
  for (const Matched& m : list) off.push_back(float(m.off_mm));
  return double(mask::median(off, 0));
}
double scale_of(const std::vector<Matched>& list, double widening_mm) {
  std::vector<float> off;
  for (const Matched& m : list) off.push_back(float(std::abs(m.off_mm - widening_mm)));
  return std::max(least_scale_mm, 1.4826 * double(mask::median(off, 1)));
}
double tukey(double off, double scale) {
  const double u = off / (4.685 * scale);
  return std::abs(u) < 1 ? (1 - u * u) * (1 - u * u) : 0;
}

itk::LinearMap improved(const std::vector<BonePoint>& points, const ScanView& scan, const itk::LinearMap& map,
                        double radius_mm) {
  const Matches m = matches_of(points, scan, map, radius_mm);
  if (m.list.size() < 50) return map;
  const double wider = widening_of(m.list), scale = scale_of(m.list, wider);
  Vec3 centre;
  for (const Matched& one : m.list) centre += one.p;
  centre = centre * (1.0 / double(m.list.size()));
  Matrix7 a = Matrix7::Zero();
  Vector7 b = Vector7::Zero();
  for (const Matched& one : m.list) {
    const double w = tukey(one.off_mm - wider, scale);
    const Vec3 turn = cross(one.p - centre, one.out);
    Vector7 j;
    j << one.out.x, one.out.y, one.out.z, turn.x, turn.y, turn.z, 1;
    a += w * j * j.transpose();
    b += w * one.off_mm * j;
  }
  a.diagonal().array() += 1e-6;
  const Vector7 x = a.ldlt().solve(b);
  return itk::then(map, rotated({x[3], x[4], x[5]}, {x[0], x[1], x[2]}, centre));
}

// By how much the bone would still stretch along the axes, beside what turns and shifts do.
double stretch_of(const std::vector<Matched>& list) {
  Vec3 centre;
  for (const Matched& one : list) centre += one.p;
  centre = centre * (1.0 / double(std::max<std::size_t>(1, list.size())));
  const double wider = widening_of(list), scale = scale_of(list, wider);
  Eigen::Matrix<double, 10, 10> a = Eigen::Matrix<double, 10, 10>::Zero();
  Eigen::Matrix<double, 10, 1> b = Eigen::Matrix<double, 10, 1>::Zero();
  for (const Matched& one : list) {
    const double w = tukey(one.off_mm - wider, 2 * scale);
    const Vec3 d = one.p - centre, turn = cross(d, one.out);
    Eigen::Matrix<double, 10, 1> j;
    j << one.out.x, one.out.y, one.out.z, turn.x, turn.y, turn.z, d.x * one.out.x, d.y * one.out.y, d.z * one.out.z, 1;
    a += w * j * j.transpose();
    b += w * one.off_mm * j;
  }
  a.diagonal().array() += 1e-6;
  const Eigen::Matrix<double, 10, 1> x = a.ldlt().solve(b);
  return std::max({std::abs(x[6]), std::abs(x[7]), std::abs(x[8])});
}

BoneFit judged(const std::vector<BonePoint>& points, const ScanView& scan, const itk::LinearMap& map) {
  BoneFit fit;
  fit.map = map;
  const Matches m = matches_of(points, scan, map, cap_mm);
  if (points.empty() || m.within == 0) return fit;
  fit.overlap_ratio = double(m.within) / double(points.size());
  fit.matched_ratio = double(m.list.size()) / double(m.within);
  fit.points = m.list.size();
  std::vector<double> off(m.within - m.list.size(), cap_mm);
  fit.widening_mm = widening_of(m.list);
  for (const Matched& one : m.list) off.push_back(std::min(cap_mm, std::abs(one.off_mm - fit.widening_mm)));
  std::sort(off.begin(), off.end());
  off.resize(std::max<std::size_t>(1, std::size_t(nearest_share * double(off.size()))));
  double sum = 0;
  for (const double d : off) sum += d * d;
  fit.residual_mm = std::sqrt(sum / double(off.size()));
  if (!m.list.empty()) fit.scale_ratio = stretch_of(m.list);
  return fit;
}

}  // namespace

BoneFit refined_fit(const std::vector<BonePoint>& points, const ScanView& scan, const itk::LinearMap& from) {
  itk::LinearMap map = from;
  for (const double radius_mm : radii_mm) map = improved(points, scan, map, radius_mm);
  return judged(points, scan, map);
}

std::optional<BoneFit> fit_bone(const std::vector<BonePoint>& points, const ScanView& scan, const Progress& progress,
                                const std::vector<double>& up_mm) {
  if (points.size() < 200) return {};
  std::vector<BonePoint> some;
  const std::size_t each = std::max<std::size_t>(1, points.size() / coarse_points);
  for (std::size_t n = 0; n < points.size(); n += each) some.push_back(points[n]);
  const DistanceMap distances(scan, progress.part(0, 0.2));
  const Vec3 middle = centroid(some);
  std::vector<Placed> found;
  const Vec3 turns[] = {{0, 0, 0}, {25, 0, 0}, {-25, 0, 0}, {0, 25, 0}, {0, -25, 0}, {0, 0, 25}, {0, 0, -25}};
  for (const Vec3& turn : turns) {
    progress.check();
    for (const double up : up_mm) {
      const itk::LinearMap start = rotated(turn * degree, distances.middle_mm - middle + Vec3{0, 0, up}, middle);
      found.push_back(descended(some, distances, start));
    }
  }
  std::stable_sort(found.begin(), found.end(), [](const Placed& a, const Placed& b) { return a.cost < b.cost; });
  std::optional<BoneFit> best;
  std::vector<itk::LinearMap> tried;
  for (const Placed& p : found) {
    if (p.cost > 1e8 || tried.size() == 3) break;
    if (std::any_of(tried.begin(), tried.end(), [&](const itk::LinearMap& t) {
          return norm(t(middle) - p.map(middle)) < 5 &&
                 norm(t(middle + Vec3{0, 0, 60}) - p.map(middle + Vec3{0, 0, 60})) < 5 &&
                 norm(t(middle + Vec3{60, 0, 0}) - p.map(middle + Vec3{60, 0, 0})) < 5;
        }))
      continue;
    tried.push_back(p.map);
    progress.check();
    const BoneFit fit = refined_fit(points, scan, p.map);
    if (fit.overlap_ratio >= least_overlap && (!best || fit.residual_mm < best->residual_mm)) best = fit;
  }
  progress.report(1);
  return best;
}

std::vector<BonePoint> mirrored(std::vector<BonePoint> points) {
  const double x = centroid(points).x;
  for (BonePoint& p : points) {
    p.at_mm.x = 2 * x - p.at_mm.x;
    p.out.x = -p.out.x;
  }
  return points;
}

LeftOutFits::LeftOutFits(const std::vector<BonePoint>& points, const ScanView& scan, const BoneFit& all,
                         const Progress& progress)
    : all_(all.map) {
  std::vector<BonePoint> seen;  // parts of what lies in the scan, or nothing would be left out
  for (const BonePoint& p : points)
    if (scan(all.map(p.at_mm)) > ScanView::beyond_hu / 2) seen.push_back(p);
  const Vec3 middle = centroid(seen);
  for (int part = 0; part < 8; ++part) {
    progress.report(part / 8.0);
    std::vector<BonePoint> rest;
    for (const BonePoint& p : seen) {
      const Vec3 d = p.at_mm - middle;
      if ((d.x > 0 ? 1 : 0) + (d.y > 0 ? 2 : 0) + (d.z > 0 ? 4 : 0) != part) rest.push_back(p);
    }
    itk::LinearMap map = all.map;
    for (int round = 0; round < 4; ++round) map = improved(rest, scan, map, cap_mm);
    without_.push_back(map);
  }
}

double LeftOutFits::standard_error_mm(Vec3 p) const {
  double sum = 0;
  for (const itk::LinearMap& map : without_) {
    const double moved = norm(map(p) - all_(p));
    sum += moved * moved;
  }
  const double n = double(std::max<std::size_t>(1, without_.size()));
  return std::sqrt((n - 1) / n * sum);
}

}  // namespace trephine::outcome
