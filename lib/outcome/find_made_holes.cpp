// SPDX-License-Identifier: GPL-3.0-or-later
#include "outcome/find_made_holes.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>

#include "base/pi.h"
#include "mask/filters.h"
#include "outcome/line.h"

namespace trephine::outcome {
namespace {

constexpr int rays = 24000;
constexpr double lowest_z = -0.15;  ///< of a ray: below it bone is thin and full of holes
constexpr double least_bone_mm = 2, most_bone_mm = 16;
constexpr double no_bone_ratio = 0.4;  ///< of what is usual beside it
constexpr double tissue_hu = 40;
constexpr double course_mm = 2.6;  ///< about a course nothing is known
constexpr double least_area_mm2 = 10, sure_area_mm2 = 25;
constexpr double grid_mm = 0.5, beside_mm = 5;
constexpr int directions = 48;
constexpr double wide_mm = 1;                         ///< of a gap behind its wall: less is a pit of the bone
constexpr double round_mm = 0.4, round_ratio = 0.08;  ///< off a circle at the median: more is none
constexpr double open_ratio = 0.8;                    ///< of the radius, within which a hole is looked at
constexpr double opening_mm2 = 500;                   ///< no burr makes a hole of 25 mm
constexpr double doubtful = 0.4;
constexpr double least_shown_ratio = 0.7;  ///< of the stretch is bone in the case's CT too, and no frontal sinus
constexpr double scalp_mm = 2.5, air_hu = -500, sunken_hu = 200;
constexpr double inside_mm = 0.4;  ///< off both tables, where HU are half of something else

double to_segment_mm(Vec3 p, Vec3 a, Vec3 b) {
  const Vec3 d = b - a;
  const double t = std::clamp(dot(p - a, d) / std::max(1e-9, dot(d, d)), 0.0, 1.0);
  return norm(p - a - d * t);
}

/// The mean HU of the scan over a stretch of the case's bone.
struct Stretch {
  bool known = false, at_course = false;
  double mean_hu = 0, air_ratio = 0;
  Vec3 outer_mm, inner_mm;
};

class BoneView {
 public:
  BoneView(const CaseHead& head, const ScanView& scan, const itk::LinearMap& map,
           const std::vector<lesson::OutcomeCourse>& courses, bool bare_bone)
      : head_(head), scan_(scan), map_(map), courses_(courses), bare_bone_(bare_bone) {}
  Stretch along(Vec3 from, Vec3 way, double reach_mm) const {
    Stretch s;
    const auto passage = passage_of(head_, from, way, reach_mm, least_bone_mm);
    if (!passage || passage->outer_mm - passage->inner_mm > most_bone_mm) return s;
    s.inner_mm = from + way * passage->inner_mm;
    s.outer_mm = from + way * passage->outer_mm;
    int count = 0, bone = 0;
    double most_hu = -1e4;
    for (double d = passage->inner_mm + inside_mm; d <= passage->outer_mm - inside_mm; d += 0.4) {
      const double v = scan_(map_(from + way * d));
      if (v <= ScanView::beyond_hu / 2) return s;
      s.mean_hu += std::max(-100.0, v);
      most_hu = std::max(most_hu, v);
      s.air_ratio += v < air_hu;
      bone += head_.shows_bone(from + way * d);
      ++count;
    }
    if (count == 0 || bone < least_shown_ratio * count) return s;
    // Beyond the scan, where no slice covers it, there is air, and no scalp on the bone. Where a piece of bone is
    // missing the scalp may have sunk in: then there is no bone either, and tissue under it.
    if (!bare_bone_ && scan_(map_(s.outer_mm + way * scalp_mm)) < air_hu &&
        (most_hu > sunken_hu || scan_(map_(s.inner_mm - way * scalp_mm)) < air_hu))
      return s;
    s.known = true;
    s.mean_hu /= count;
    s.air_ratio /= count;
    const Vec3 middle = (s.inner_mm + s.outer_mm) * 0.5;
    for (const lesson::OutcomeCourse& c : courses_) {
      const Vec3 on = normalized(c.outer_mm - c.inner_mm);
      if (norm(c.outer_mm - c.inner_mm) > 0.1 &&
          to_segment_mm(middle, c.inner_mm - on * 8, c.outer_mm + on * 12) < course_mm)
        s.at_course = true;
    }
    return s;
  }

 private:
  const CaseHead& head_;
  const ScanView& scan_;
  const itk::LinearMap& map_;
  const std::vector<lesson::OutcomeCourse>& courses_;
  bool bare_bone_;
};

Vec3 out_of_bone(const CaseHead& head, Vec3 outer_mm) {
  Vec3 sum;
  for (int a = 0; a < 3; ++a)
    for (const double d : {-3.0, 0.0, 3.0}) {
      Vec3 p = outer_mm;
      p[a] += d;
      sum -= head.decoder.gradient(head.bone, p);
    }
  return norm(sum) > 1e-6 ? normalized(sum) : normalized(outer_mm - head.middle_mm);
}

/// A place across the hole's axis where half of the bone is gone.
struct WallPoint {
  double x = 0, y = 0;
};
struct Circle {
  double x = 0, y = 0, radius = 0, off_mm = 1e9;  ///< the median of how far the wall lies off
};
// By least squares of the distances; what is far off counts less.
Circle circle_through(const std::vector<WallPoint>& wall) {
  Circle c;
  std::vector<float> off;
  for (const WallPoint& w : wall) c.x += w.x / double(wall.size()), c.y += w.y / double(wall.size());
  for (const WallPoint& w : wall) off.push_back(float(std::hypot(w.x - c.x, w.y - c.y)));
  c.radius = double(mask::median(off, 0));
  for (int round = 0; round < 20; ++round) {
    off.clear();
    for (const WallPoint& w : wall) off.push_back(float(std::abs(std::hypot(w.x - c.x, w.y - c.y) - c.radius)));
    c.off_mm = double(mask::median(off, 0));
    const double scale = 4.685 * std::max(0.1, 1.4826 * c.off_mm);
    Eigen::Matrix3d a = 1e-9 * Eigen::Matrix3d::Identity();
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
    for (const WallPoint& w : wall) {
      const double r = std::max(1e-6, std::hypot(w.x - c.x, w.y - c.y)), d = r - c.radius, u = d / scale;
      if (std::abs(u) >= 1) continue;
      const Eigen::Vector3d j((w.x - c.x) / r, (w.y - c.y) / r, 1);
      const double weight = (1 - u * u) * (1 - u * u);
      a += weight * j * j.transpose(), b += weight * d * j;
    }
    const Eigen::Vector3d step = a.ldlt().solve(b);
    c.x += step[0], c.y += step[1], c.radius += step[2];
  }
  return c;
}

/// The gap across one axis: its wall in each direction, and how much of it holds air.
struct Gap {
  std::vector<WallPoint> wall;
  double air_ratio = 0;
};
// Each ray of stretches along `out` comes from the bone beside the gap inwards to where half of the bone is gone, so
// that a catheter in the gap, as dense as bone, is no wall. Behind a course nothing is known.
Gap gap_across(const BoneView& view, Vec3 centre, Vec3 out, Vec3 a, Vec3 b, double reach_mm, double bone_hu) {
  Gap gap;
  double air = 0, inside = 0;
  for (int n = 0; n < directions; ++n) {
    const double turn = 2 * pi * n / directions, x = std::cos(turn), y = std::sin(turn);
    double before = 0, gone_mm = 0;
    WallPoint at;
    for (double r = reach_mm; r >= 0; r -= grid_mm / 2) {
      const Stretch s = view.along(centre + (a * x + b * y) * r - out * 22, out, 34);
      if (!s.known || s.at_course) {
        if (gone_mm < wide_mm) gone_mm = 0;
        break;
      }
      const double share = (bone_hu - s.mean_hu) / std::max(1.0, bone_hu - tissue_hu);
      if (share < 0.5) {
        gone_mm = 0;
      } else {
        if (gone_mm == 0) {
          const double back = r + grid_mm / 2 * (share > before ? std::min(1.0, (share - 0.5) / (share - before)) : 0);
          at = {back * x, back * y};
        }
        gone_mm += grid_mm / 2;
        air += s.air_ratio, ++inside;
        if (gone_mm > 2 * wide_mm) break;
      }
      before = share;
    }
    if (gone_mm >= wide_mm && std::hypot(at.x, at.y) < reach_mm - grid_mm) gap.wall.push_back(at);
  }
  if (inside > 0) gap.air_ratio = air / inside;
  return gap;
}

/// The median of what is usual in the bone in a ring; nothing where too little of it is known.
std::optional<double> usual_hu(const BoneView& view, Vec3 centre, Vec3 out, Vec3 a, Vec3 b, double from, double to) {
  std::vector<float> usual;
  const int n = int(to);
  for (int i = -n; i <= n; ++i)
    for (int j = -n; j <= n; ++j) {
      if (std::hypot(i, j) > to || std::hypot(i, j) <= from) continue;
      const Stretch s = view.along(centre + a * double(i) + b * double(j) - out * 22, out, 34);
      if (s.known && !s.at_course) usual.push_back(float(s.mean_hu));
    }
  if (usual.size() < 20) return {};
  return double(mask::median(usual, 1000));
}

/// Whether bone is gone over most of the disc: not so within the narrow cleft around a piece that was put back.
bool is_open(const BoneView& view, Vec3 centre, Vec3 out, Vec3 a, Vec3 b, double radius_mm, double bone_hu) {
  int seen = 0, gone = 0;
  const int n = int(open_ratio * radius_mm / grid_mm);
  for (int i = -n; i <= n; ++i)
    for (int j = -n; j <= n; ++j) {
      if (i * i + j * j > n * n) continue;
      const Stretch s = view.along(centre + (a * double(i) + b * double(j)) * grid_mm - out * 22, out, 34);
      if (!s.known || s.at_course) continue;
      ++seen;
      gone += bone_hu - s.mean_hu > 0.5 * (bone_hu - tissue_hu);
    }
  return 2 * gone >= seen;
}

/// The gap about a place, by rays along one axis.
std::optional<lesson::OutcomeHole> measured(const CaseHead& head, const BoneView& view, Vec3 outer_mm, double radius_mm,
                                            double slice_mm) {
  Vec3 centre = outer_mm, out = out_of_bone(head, outer_mm);
  if (dot(out, centre - head.middle_mm) < 0) return {};
  double area = 0, air = 0, spread[2] = {0, 0};
  for (int round = 0; round < 3; ++round) {
    const Vec3 a = perpendicular_to(out), b = cross(out, a);
    const double reach = radius_mm + 2 * beside_mm;
    const auto bone_hu = usual_hu(view, centre, out, a, b, radius_mm + beside_mm, reach);
    if (!bone_hu) return {};
    const Gap gap = gap_across(view, centre, out, a, b, reach - 1, *bone_hu);
    if (int(gap.wall.size()) < directions / 3) return {};
    air = gap.air_ratio;
    const Circle circle = circle_through(gap.wall);
    double mx = circle.x, my = circle.y;
    area = pi * circle.radius * circle.radius;
    if (circle.off_mm > round_mm + round_ratio * circle.radius && int(gap.wall.size()) > 2 * directions / 3) {
      area = 0, mx = 0, my = 0;  // no circle: what the wall encloses
      for (std::size_t n = 0; n < gap.wall.size(); ++n) {
        const WallPoint &p = gap.wall[n], &q = gap.wall[(n + 1) % gap.wall.size()];
        const double part = 0.5 * (p.x * q.y - q.x * p.y);
        area += part, mx += part * (p.x + q.x) / 3, my += part * (p.y + q.y) / 3;
      }
      if (!(area > 1)) return {};
      mx /= area, my /= area;
    }
    if (!is_open(view, centre + a * mx + b * my, out, a, b, std::sqrt(area / pi), *bone_hu)) return {};
    double aa = 0, bb = 0, ab = 0;
    for (const WallPoint& w : gap.wall)
      aa += (w.x - mx) * (w.x - mx), bb += (w.y - my) * (w.y - my), ab += (w.x - mx) * (w.y - my);
    const double half = 0.5 * (aa + bb), root = std::sqrt(std::max(0.0, 0.25 * (aa - bb) * (aa - bb) + ab * ab));
    spread[0] = std::sqrt(std::max(0.0, half + root)), spread[1] = std::sqrt(std::max(0.0, half - root));
    centre += a * mx + b * my;
    if (const auto p = passage_of(head, centre - out * 22, out, 34, least_bone_mm))
      centre = centre - out * (22 - p->outer_mm);
    out = out_of_bone(head, centre);
    radius_mm = std::max(2.0, std::sqrt(area / pi));
  }
  if (area < least_area_mm2) return {};
  lesson::OutcomeHole hole;
  hole.outer_mm = centre;
  hole.out = out;
  const auto p = passage_of(head, centre - out * 22, out, 34, least_bone_mm);
  if (!p) return {};
  hole.inner_mm = centre - out * (p->outer_mm - p->inner_mm);
  hole.bone_mm = p->outer_mm - p->inner_mm;
  hole.area_mm2 = area;
  hole.diameter_mm = 2 * std::sqrt(area / pi);
  hole.side = head.side_of(centre);
  // Round, or so wide that it is no thin place; several slices wide.
  const double round = spread[0] > 0 ? spread[1] / spread[0] : 0;
  hole.confidence = mask::ramp(area, least_area_mm2, sure_area_mm2) *
                    std::max(mask::ramp(round, 0.3, 0.6), mask::ramp(hole.diameter_mm, 15, 30)) *
                    mask::ramp(hole.diameter_mm / slice_mm, 0.8, 1.6);
  // A case without a CT does not say whether its bone there is an air cell, such as a frontal sinus.
  if (!head.loaded.has_ct() && air > 0.4) hole.confidence = std::min(hole.confidence, doubtful);
  return hole;
}

/// What rays through a wide gap say of it: the bone's surface that each of them stands for. Nothing where a burr may
/// have made it, or where it is a narrow cleft.
std::optional<lesson::OutcomeOpening> opening_of(const CaseHead& head, const std::vector<Stretch>& gap) {
  lesson::OutcomeOpening o;
  std::vector<float> bone;
  double area_mm2 = 0;
  Vec3 sum;
  for (const Stretch& s : gap) {
    const Vec3 from = s.outer_mm - head.middle_mm;
    const double away = norm(from), slant = std::abs(dot(out_of_bone(head, s.outer_mm), from)) / away;
    const double part = 4 * pi * away * away / rays / std::max(0.3, slant);
    area_mm2 += part;
    sum += from * part;
    bone.push_back(float(norm(s.outer_mm - s.inner_mm)));
  }
  if (area_mm2 < opening_mm2) return {};
  const Vec3 way = normalized(sum);
  const auto middle = passage_of(head, head.middle_mm, way, 140, least_bone_mm);
  o.middle_mm = head.middle_mm + way * (middle ? middle->outer_mm : norm(sum) / area_mm2);
  o.out = out_of_bone(head, o.middle_mm);
  const Frame across(o.out);
  std::vector<const Stretch*> farthest(directions, nullptr);
  const auto off = [&](const Stretch& s) {
    const Vec3 d = s.outer_mm - o.middle_mm;
    return std::hypot(dot(d, across.a), dot(d, across.b));
  };
  for (const Stretch& s : gap) {
    const Vec3 d = s.outer_mm - o.middle_mm;
    const int n = int((std::atan2(dot(d, across.b), dot(d, across.a)) / (2 * pi) + 0.5) * directions) % directions;
    const Stretch*& most = farthest[std::size_t(n)];
    if (!most || off(s) > off(*most)) most = &s;
  }
  for (const Stretch* s : farthest)
    if (s) o.border.push_back({s->outer_mm});
  for (const lesson::OutcomePlace& p : o.border)
    for (const lesson::OutcomePlace& q : o.border) o.longest_mm = std::max(o.longest_mm, norm(p.at_mm - q.at_mm));
  o.area_cm2 = area_mm2 / 100;
  o.bone_mm = double(mask::median(bone, 0));
  o.side = head.side_of(o.middle_mm);
  // Of a disc its longest chord gives the area; a cleft is long for what it opens, and so is the rim of bone that is
  // lost where a scan ends in padding.
  o.confidence = mask::ramp(area_mm2 / (pi / 4 * o.longest_mm * o.longest_mm), 0.3, 0.6) *
                 mask::ramp(area_mm2, opening_mm2, 1.5 * opening_mm2);
  return o;
}

}  // namespace

MadeGaps find_made_holes(const CaseHead& head, const ScanView& scan, const itk::LinearMap& map,
                         const std::vector<lesson::OutcomeCourse>& courses, bool bare_bone, const Progress& progress) {
  const BoneView view(head, scan, map, courses, bare_bone);
  std::vector<Stretch> seen;
  std::vector<float> all;
  for (int n = 0; n < rays; ++n) {  // evenly over the sphere, along a spiral
    if (n % 1000 == 0) progress.report(0.8 * n / rays);
    const double z = 1 - 2 * (n + 0.5) / rays, r = std::sqrt(1 - z * z), turn = pi * (3 - std::sqrt(5.0)) * n;
    if (z < lowest_z) break;
    const Stretch s = view.along(head.middle_mm, {r * std::cos(turn), r * std::sin(turn), z}, 140);
    if (!s.known) continue;
    seen.push_back(s);
    if (!s.at_course) all.push_back(float(s.mean_hu));
  }
  if (all.size() < 500) return {};
  const double usual = double(mask::median(all, 1000));
  std::vector<Stretch> gap;
  for (const Stretch& s : seen)
    if (!s.at_course && s.mean_hu < tissue_hu + no_bone_ratio * (usual - tissue_hu)) gap.push_back(s);
  // Places that lie beside each other are one gap; a course may part them.
  const double near_mm = 2 * course_mm + 1.5;
  std::vector<char> used(gap.size(), 0);
  MadeGaps found;
  std::vector<lesson::OutcomeHole>& holes = found.holes;
  const Vec3 spacing = scan.lattice().spacing_mm;
  const double slice_mm = std::max({spacing.x, spacing.y, spacing.z});
  for (std::size_t first = 0; first < gap.size(); ++first) {
    if (used[first]) continue;
    std::vector<std::size_t> members{first};
    used[first] = 1;
    for (std::size_t m = 0; m < members.size(); ++m)
      for (std::size_t o = 0; o < gap.size(); ++o)
        if (!used[o] && norm(gap[o].outer_mm - gap[members[m]].outer_mm) < near_mm) used[o] = 1, members.push_back(o);
    if (members.size() < 3) continue;
    Vec3 middle;
    for (const std::size_t m : members) middle += gap[m].outer_mm * (1.0 / double(members.size()));
    double radius = 2;
    for (const std::size_t m : members) radius = std::max(radius, norm(gap[m].outer_mm - middle));
    std::vector<Stretch> here;
    for (const std::size_t m : members) here.push_back(gap[m]);
    if (const auto opening = opening_of(head, here)) {
      if (opening->confidence > 0) found.openings.push_back(*opening);
      continue;
    }
    const auto hole = measured(head, view, middle, radius, slice_mm);
    if (!hole) continue;
    if (std::any_of(holes.begin(), holes.end(), [&](const lesson::OutcomeHole& h) {
          return norm(h.outer_mm - hole->outer_mm) < 0.5 * (h.diameter_mm + hole->diameter_mm);
        }))
      continue;
    holes.push_back(*hole);
  }
  std::stable_sort(holes.begin(), holes.end(), [](const auto& a, const auto& b) { return a.area_mm2 > b.area_mm2; });
  std::stable_sort(found.openings.begin(), found.openings.end(),
                   [](const auto& a, const auto& b) { return a.area_cm2 > b.area_cm2; });
  progress.report(1);
  return found;
}

}  // namespace trephine::outcome
